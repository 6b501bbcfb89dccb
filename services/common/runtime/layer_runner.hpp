// Runs one layer over a bus with a journal, by the contract of port/layer.hpp and the stream protocol of
// message/service.hpp.
//
//   receive -> put streams in order -> layers conclude -> [journal: inputs, conclusions, positions: one transaction]
//           -> publish
//
// Each asset's layer concludes in a lane of its own (asset_lanes.hpp). What is not concluded from at once waits in the
// journal, so that a slow asset neither holds up the others nor fills the memory.
//
// What is published was committed before; what was committed and not published, because the process was killed in
// between, is asked for by its readers, as the heartbeat says how far each stream goes. A layer that was stopped at any
// point and is run again on the same journal ends with the same outputs.
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/port/bus.hpp"
#include "sealwatch/port/layer.hpp"
#include "sealwatch/port/local_inputs.hpp"
#include "sealwatch/port/standing_alarms.hpp"
#include "services/common/runtime/admission.hpp"
#include "services/common/runtime/alarm_desk.hpp"
#include "services/common/runtime/alarms.hpp"
#include "services/common/runtime/asset_lanes.hpp"
#include "services/common/runtime/clock_watch.hpp"
#include "services/common/runtime/daily_acts.hpp"
#include "services/common/runtime/heartbeat.hpp"
#include "services/common/runtime/latest_outputs.hpp"
#include "services/common/runtime/outbox.hpp"
#include "services/common/runtime/recalled_alarm_acts.hpp"
#include "services/common/runtime/resend_queue.hpp"
#include "services/common/runtime/retention.hpp"
#include "services/common/runtime/stranger_watch.hpp"
#include "services/common/runtime/stream_reader.hpp"
#include "services/common/store/journal.hpp"

namespace sealwatch {

struct RunnerOptions {
  std::string version = {};
  std::string build = {};  ///< of this program: what one build packed (store/packed_past.hpp) no other reads
  Heartbeat::Options heartbeat = {};
  /// Batches begin so far apart at least: of a thousand messages a second, two or three share a transaction, which
  /// nearly halves what is written to the journal.
  std::chrono::milliseconds batch_pause{2};
  /// A batch is committed when all layers have concluded from it, or after so long: the rest is then kept as it came.
  std::chrono::milliseconds batch_time{20};
  /// Time does not pass for the layer until the writers have had so long to say what it missed while it was dead.
  std::chrono::milliseconds settling{3000};
  /// A start gives assets their past back, and looks for damage, for so long: all of a short history. The rest follows
  /// while the service runs, an asset's past before anything is taken of it.
  std::chrono::milliseconds recalls_at_start{1000};
  /// Outputs of which layers keep the past: beyond it, the assets used longest ago forget theirs, which is recalled when
  /// it is needed again. Of twenty years of monthly tests an asset has 250 to 750.
  std::size_t most_recalled = 50'000;
  /// Used so recently, an asset keeps its past all the same: a test under way is cut after a minute without samples.
  std::chrono::milliseconds least_awake{120'000};
  /// After so long an asset is recalled all the same: time passes for it too, and its tests become overdue.
  std::chrono::milliseconds longest_sleep{3'600'000};
  /// Where the journal is new, nothing that others concluded is taken until what people said is fetched back, but for no
  /// longer than this: a service that never runs tells nothing.
  std::chrono::milliseconds longest_without_acts{10'000};
  /// A neighbour's record of an act waits so long for the act itself, which reaches some services sooner than others.
  std::chrono::milliseconds records_wait{3000};
  /// Nor while the bus is not emptied, but for no longer than this: what then still waits is a flood's, as a bus gives
  /// each sender its turn.
  std::chrono::milliseconds longest_wait{5000};
  /// Nor while more is known to come about an asset, but for no longer than this: a test is overdue by days, and a stream
  /// that goes on for ever is a forger's.
  std::chrono::milliseconds longest_behind{std::chrono::hours(1)};
  std::shared_ptr<LocalInputs> local_inputs = {};
  /// A piece of them is taken when no more than so many inputs wait to be concluded from, and no reader that is heard is
  /// further behind than a stream's window: what is live goes first, here and in the layers behind.
  std::size_t most_open_beside_local = 64;
  /// Assets for which time passes also where nothing has been heard of them.
  std::vector<std::string> assets = {};
  AssetLanes::Options lanes = {};
  StreamReader::Limits streams = {};
  /// Streams whose positions are kept; beyond, only of writers of whom something was taken: strangers invent names.
  std::size_t most_positions = 4096;
  std::map<std::string, UtcTime> commissioned = {};  ///< by asset; no test is older
  /// Whether a clock of this machine that was set or follows no time source is an alarm of this service: tests are
  /// dated by it.
  bool watches_clock = false;
  /// How well that clock is kept, which stands in every message. Asked about once a second.
  std::function<ClockReading()> read_clock = {};
  bool refuses_unknown_assets = false;    ///< takes `assets` alone
  bool acts_confirmed_by_second = false;  ///< see message/confirmation.hpp
  /// An act waits so long for a second person, or for what it means to be known; by the wall clock, across restarts.
  std::chrono::milliseconds longest_wait_of_act{3'600'000};
  StrangerWatch::Options strangers = {};
  std::chrono::milliseconds strangers_stand{3'600'000};         ///< how long an alarm of who is heard no more stands
  std::chrono::milliseconds refusals_stand{90LL * 86'400'000};  ///< an alarm of a sender that is refused no more
  /// What the bus has refused to others since the last call, in words; nothing when it was nothing.
  std::function<std::optional<std::string>()> refused_by_bus = {};
  std::chrono::milliseconds resent_at_once = ResendQueue::kAtOnce;  ///< the same is not sent again to one reader
  AlarmsOfOutput alarms_of_output = {};
  std::optional<AlarmDesk::Options> desk = {};  ///< of the one service that keeps the states of all alarms
  AdviceOfOutput advice_of_output = {};
  RetentionConfig retention = {};
  std::chrono::milliseconds retention_pause{60'000};  ///< between two looks for old samples
};

class LayerRunner {
 public:
  /// Everything must outlive the runner. `heartbeat_bus` is used by a thread of the runner's own.
  LayerRunner(const LayerMaker& make_layer, Bus& bus, Bus& heartbeat_bus, Journal& journal, const Clock& clock,
              RunnerOptions options = {});

  /// Subscribes, gives the layers their past back, publishes the last state of every asset.
  [[nodiscard]] Status start();
  /// One round: takes what the bus has (waiting at most `timeout`), concludes, commits, publishes, serves requests.
  /// After an Error the runner cannot go on: layers may be ahead of the journal. Start again from the journal.
  [[nodiscard]] Status step(std::chrono::milliseconds timeout);
  /// Steps until `stop` is set (then wake the bus).
  [[nodiscard]] Status run(const std::atomic<bool>& stop);
  /// Stops all computing. False when some of it goes on after `patience`: then only the end of the process stops it.
  [[nodiscard]] bool stop(std::chrono::milliseconds patience);

 private:
  using Key = std::pair<std::string, std::string>;  // topic, writer id
  /// An input of the running batch.
  struct Taken {
    std::shared_ptr<const Message> message;
    StreamPosition stream;
    InputState state = InputState::open;
  };

  void sort_in(BusItem item);
  void sort_in(Message message);
  void sort_in(const ServiceStatus& status);
  void sort_in(const ResendRequest& request);
  [[nodiscard]] Result<KnownInput> known_as(const Message& message);
  void note_reused_number(const Message& message);
  void start_anew(const Key& stream);
  /// Runs `work` inside a transaction and publishes what it concluded.
  [[nodiscard]] Status in_batch(const std::function<Status()>& work, Survives survives = Survives::kills);
  [[nodiscard]] Survives batch_survives() const;
  [[nodiscard]] Status take_ready();
  [[nodiscard]] Status take_all_in_turn();
  /// Also of what is taken and not yet committed; none where it is not known.
  [[nodiscard]] Result<std::optional<std::string>> asset_of_input(const std::string& message_id);
  [[nodiscard]] Status name_as_kept(Message& message);
  /// `record`: of a neighbour, from which the message is fetched back; null where it came itself.
  [[nodiscard]] Status take(Message message, const ActRecord* record = nullptr);
  /// Why it is not taken; none for nearly all.
  [[nodiscard]] std::optional<std::string> refusal_of(const Message& message, const ActRecord* record) const;
  [[nodiscard]] std::optional<std::string> refusal_of_content(const Message& message) const;
  [[nodiscard]] static std::optional<std::string> refusal_of_nameless(const Message& message);
  [[nodiscard]] Result<std::optional<std::string>> identify_input(const Message& message);
  /// Gives the lanes a moment to conclude from what was taken.
  [[nodiscard]] Result<std::optional<Message>> input(const std::string& message_id);
  [[nodiscard]] Status let_lanes_work();
  [[nodiscard]] bool may_take_local();
  void hear_reader(const ServiceStatus& status);
  [[nodiscard]] bool is_a_reader_behind() const;
  void take_local();
  [[nodiscard]] Status store_batch();
  void give_memory_back();
  [[nodiscard]] Status keep(Conclusion conclusion);
  [[nodiscard]] Status let_time_pass();
  [[nodiscard]] bool time_stands_still(const std::string& asset_id);
  [[nodiscard]] UtcTime believed_time() const;
  [[nodiscard]] bool may_be_on_its_way(const std::string& asset_id);
  [[nodiscard]] Status serve_resends();
  [[nodiscard]] Status publish_latest();
  void send_requests();
  /// False when the bus did not take it now.
  bool publish(Message& message, std::string_view event);
  void send_outbox();
  void note_error(const std::string& text);
  [[nodiscard]] std::vector<StreamPosition> position_of_acts() const;
  /// How far the own streams go, and the record of acts.
  [[nodiscard]] std::vector<StreamPosition> written() const;
  [[nodiscard]] std::vector<StreamPosition> received() const;
  void report_progress();

  // The past (layer_runner_past.cpp).
  [[nodiscard]] Status restore_past();
  /// Gives the asset's layer its past back, where it has not got it yet.
  [[nodiscard]] Status recall(const std::string& asset_id);
  [[nodiscard]] Status recall_inputs(const std::string& asset_id);
  /// Gives a layer its own outputs, and nothing else, back.
  [[nodiscard]] Status restore_layer(const std::string& asset_id);
  /// Counts an output that the asset's layer remembers.
  void note_remembered(const std::string& asset_id);
  /// Lets assets forget their past where all of them together remember too much.
  [[nodiscard]] Status forget_some();
  [[nodiscard]] Status wake_longest_asleep();
  [[nodiscard]] Status look_back();
  [[nodiscard]] Status look_back(std::chrono::milliseconds at_most);
  [[nodiscard]] Status look_back_in_passing(bool is_idle);
  [[nodiscard]] std::chrono::milliseconds until_looking_back(std::chrono::milliseconds timeout) const;

  // What keeps the service from seeing (layer_runner_alarms.cpp).
  void note_rival(const ServiceStatus& rival);
  void hear_name(const ServiceStatus& status);
  void note_strangers(const std::vector<StrangerWatch::Stranger>& strangers);
  void note_refused_test(const RawSamples& raw, const std::string& refused);
  void note_conclusion(const Message& message, const std::optional<std::string>& refused);
  void note_good_test(const RawSamples& raw);
  /// A sender, or the folder, of whose tests of an asset one was refused.
  struct RefusedTest {
    ServiceAlarm alarm;        ///< its subject is the source
    UtcTime last;              ///< when one was refused
    std::string recording_id;  ///< of that one; "" after a restart
    Alarms::Steady heard;  ///< of it, or this service's start: what is forgotten does not go by a clock that is wrong
  };
  [[nodiscard]] static bool is_of(const RefusedTest& refused, const RawSamples& raw);
  void tell_of_refused_tests();
  void end_refused_tests(const std::function<bool(const RefusedTest&)>& is_over);
  [[nodiscard]] Status restore_refused_tests();
  [[nodiscard]] Status keep_refused_tests();
  void look_at_clock();
  void tell_of_step();
  void tell_of_synchronisation(ClockQuality quality);
  void tell_of_local_inputs();
  void tell_of_floods();
  void tell_of_missing_blocks();
  void tell_of_missing_messages();
  /// Live tests that change no advice, as one that was played back is of the future.
  void look_for_future_test(const std::string& asset_id);
  void note_unknown_asset(const Message& message, const std::string& refused);
  void note_alarms_of(const Message& output);
  void tell_of_waiting(const std::string& asset_id, const Layer& layer);
  void look_for_trouble();

  // The states of all alarms (layer_runner_desk.cpp).
  [[nodiscard]] Status open_desk();
  void note_advice_of(const Message& output);
  /// Whether people speak to the desk with it, not to the layer; of what is fetched back, its alarm may not be there yet.
  [[nodiscard]] bool is_for_desk(const Message& message, bool is_fetched_back) const;
  /// Does it where this service has the desk; why not, where it is refused.
  [[nodiscard]] std::optional<std::string> tell_desk(const Message& message);
  /// The same, of an act that is fetched back: done once what it was said of is there.
  [[nodiscard]] std::optional<std::string> recall_at_desk(const Message& message);
  [[nodiscard]] Status restore_recalled_at_desk();
  /// In the running batch: what became of those.
  [[nodiscard]] Status answer_recalled();
  [[nodiscard]] Status keep_alarms();
  [[nodiscard]] Status keep_over();
  [[nodiscard]] Status let_time_pass_at_desk();

  // What people say (layer_runner_acts.cpp).
  [[nodiscard]] Status restore_awaiting();
  [[nodiscard]] Status restore_ahead();
  void await(std::shared_ptr<const Message> act, UtcTime since);
  [[nodiscard]] std::ptrdiff_t waiting_acts(const std::string& asset_id) const;
  [[nodiscard]] std::optional<std::string> refusal_of_confirmation(const Message& message,
                                                                   const ActRecord* record) const;
  [[nodiscard]] std::optional<std::string> refusal_of_waiting(const Message& message) const;
  [[nodiscard]] bool waits_for_second(const Message& message) const;
  /// Writes down who said it, and what becomes of it: `state` for what no person said.
  [[nodiscard]] InputState note_act(const Message& message, const std::optional<std::string>& refused, InputState state,
                                    const ActRecord* record);
  /// The outcome of an act that its layer is given.
  [[nodiscard]] std::string outcome_of_taken(const Message& message);
  /// Notes that an act was refused; whether it is kept. Of the others the record says how many there are.
  [[nodiscard]] bool keeps_refused(const Message& act, const std::string& refused);
  [[nodiscard]] std::optional<std::string> refusal_of_ahead(const Message& message) const;
  /// Whether an act is refused because what it means is not known here, or as one of too many: where a neighbour takes
  /// it, it comes again.
  [[nodiscard]] bool may_be_fetched_later(const Message& message) const;
  /// Gives layers the acts that were ahead of what they mean, as far as that is known now.
  [[nodiscard]] Status give_acts_ahead();
  [[nodiscard]] Status give_acts_ahead(const std::string& asset_id);
  void give(const std::shared_ptr<const Message>& act);
  /// Gives the layer what this confirms, and forgets what it rejects.
  void confirm(const Message& message);
  [[nodiscard]] Status record_acts();
  // How many of them there may be, and for how long they wait (layer_runner_bounds.cpp).
  /// The sort of acts with which it counts towards those of a day; none where their number is bounded otherwise.
  [[nodiscard]] std::optional<std::string> counted_as(const Message& act) const;
  [[nodiscard]] std::optional<std::string> refusal_of_many(const Message& message) const;
  /// Of an act that is taken as it was said here.
  void count_act(const Message& act);
  /// From the audit trail: a restart begins no new day. Those of an asset count once its advice is recalled, which tells
  /// acknowledgements apart.
  void restore_counts(const std::vector<AuditEntry>& acts);
  void count_past_acts(const std::string& asset_id);
  void tell_of_many(const Message& act, const std::string& refused);
  [[nodiscard]] bool has_waited_too_long(UtcTime since) const;
  /// A neighbour has taken an act that is ahead here: it waits for what it means, however long that takes.
  void note_taken_elsewhere(const ActRecord& record, const Message& act);
  /// About once a second.
  [[nodiscard]] Status end_waits();
  void give_up(const Message& act, const std::string& why);
  [[nodiscard]] UtcTime time_said(const ActRecord* record) const;
  // What the services keep of it for each other (layer_runner_records.cpp).
  [[nodiscard]] bool keeps_acts() const;
  [[nodiscard]] bool is_listened_to(const Message& act) const;
  void name_tests(Message& act) const;
  /// Writes the act into the own record, in the running batch.
  void keep_record(const Message& act, bool is_ahead);
  /// Whether an act is kept for others. To the desk it is what concerns an alarm that may still stand.
  [[nodiscard]] bool is_to_be_kept(const Message& act, bool is_for_desk) const;
  /// Once, after an update from a version that kept no such record.
  [[nodiscard]] Status record_earlier_acts();
  /// In a retraction of many: the tests that were known then.
  [[nodiscard]] Status name_tests_known(MaintenanceEvent& event, UtcTime at);
  /// Of a neighbour: the act in it is taken where it is not known here.
  [[nodiscard]] Status take_record(Message message, const StreamPosition& stream);
  /// Says so where it is one.
  [[nodiscard]] bool is_false_record(const Message& message);
  void put_in_line(Message message);
  /// Puts those into line whose act has come, or does not come.
  [[nodiscard]] Status release_records();
  [[nodiscard]] Result<bool> waits_for_its_act(const Message& record);
  /// Whether it is not taken now: it waits, or comes again.
  [[nodiscard]] bool waits_for_acts(const Message& message);
  void look_whether_acts_are_here();
  void note_standing(const Message& output);
  [[nodiscard]] bool is_of_later_advice(const Message& act) const;
  /// Whether an act that is fetched back, or was ahead, is given to the layer now.
  [[nodiscard]] bool is_its_turn(const Message& act) const;
  /// Nothing more is known to come about the asset.
  [[nodiscard]] bool is_quiet(const std::string& asset_id) const;
  void look_whether_assets_are_quiet();

  /// What another service tells of its record of acts.
  void hear_of_acts(const ServiceStatus& status);
  void keep_anchor(const AuditAnchor& heard);
  /// The name of another service that has a history: who loses it with its journal hears it here.
  void keep_name(const ServiceStatus& status);
  /// Whether the position in the journal is such a name.
  [[nodiscard]] bool restore_name(const StreamPosition& known);
  void note_older_acts(const ServiceStatus& status);
  [[nodiscard]] std::optional<std::string> lost_for_ever() const;
  void hear_of_own_outputs(const ServiceStatus& status);
  void tell_of_false_position(const ServiceStatus& status, const StreamPosition& read, std::uint64_t written);
  [[nodiscard]] std::optional<std::string> samples_lost_with(const std::string& other) const;
  [[nodiscard]] Status tell_of_journal(const std::string& reason, const std::optional<std::string>& lost);
  [[nodiscard]] bool reads_samples() const;
  /// Keeps it, and looks how far the own record goes.
  [[nodiscard]] Status note_acts();
  [[nodiscard]] Status look_at_own_acts();
  /// Where the journal is new and others' records are not, what people said to this service is lost: an alarm.
  [[nodiscard]] Status compare_acts();
  [[nodiscard]] bool all_heard() const;
  [[nodiscard]] Status record(const OperatorAct& act);
  /// What a layer does not act upon.
  [[nodiscard]] Status tell(const Refusal& refused);
  struct PastAct {
    UtcTime at;  ///< when it came to count
    std::string id;
  };
  /// Retractions and withdrawals that counted before this start, in order, by asset.
  [[nodiscard]] static std::map<std::string, std::vector<PastAct>> past_retractions(
      const std::vector<AuditEntry>& acts);

  // What is kept for how long (layer_runner_retention.cpp).
  [[nodiscard]] Status drop_old_samples();
  /// Whether any were dropped.
  [[nodiscard]] Result<bool> drop_old_samples(const Retention::Sample& sample);
  [[nodiscard]] bool is_needed(const Retention::Sample& sample, const Journal::Kept& one) const;
  [[nodiscard]] bool is_set_aside_anywhere(const std::string& asset_id, const std::string& pst_id) const;
  bool has_no_samples_any_more(const Message& message);

  // What is set aside (layer_runner_quarantine.cpp).
  [[nodiscard]] Status restore_quarantine();
  [[nodiscard]] bool is_set_aside(const Message& message) const;
  [[nodiscard]] Status take_failures();
  [[nodiscard]] Status set_aside(const LaneResult& failure);
  void raise_alarm(const SetAside& message);
  /// An output that was damaged in the journal is there again.
  void forget_damage(const std::string& message_id);
  /// Gives the asset a new layer, its past and its open inputs.
  [[nodiscard]] Status begin_anew(const std::string& asset_id);
  [[nodiscard]] Status try_again_what_was_asked();
  void note_set_aside_elsewhere(const ServiceStatus& other);
  [[nodiscard]] Status count_what_waits_in_vain();

  const std::unique_ptr<Layer> kind_;  ///< of no asset: says what all of them are called and read
  std::vector<Topic> inputs_;          ///< what the layer reads, and the neighbours' records of acts
  std::vector<Topic> outputs_;         ///< what it writes, and the own record of acts
  Bus& bus_;
  Bus& heartbeat_bus_;
  Journal& journal_;
  const Clock& clock_;
  RunnerOptions options_;
  std::unique_ptr<StreamReader> reader_;
  std::deque<Message> ready_;  ///< inputs in order, not yet taken
  std::vector<Taken> taken_;   ///< the running batch, in order
  std::map<std::string, std::size_t> taken_ids_;
  std::vector<Message> renumbered_;  ///< known inputs that came under another number
  std::map<std::pair<Topic, std::string>, std::string> last_unnumbered_;  ///< of the running batch, by topic and asset
  struct Waiting {
    std::shared_ptr<const Message> act;
    UtcTime since;
  };
  std::map<std::string, Waiting> awaiting_;               ///< acts that wait for a second person, by id
  std::map<std::string, InputState> no_longer_awaiting_;  ///< ids of those whose wait is over, of this batch
  std::map<std::string, std::size_t> acts_ahead_;         ///< acts that wait for what they mean, by asset
  std::set<std::string> awaits_quiet_;  ///< of those assets, the ones with acts that were fetched back
  std::set<std::string> heard_of_;      ///< of those assets, the ones of which something new is known
  struct Said {
    std::string asset_id;
    UtcTime since;
  };
  std::map<std::string, Said> said_ahead_;  ///< of those, by id, the ones that no neighbour has taken
  std::vector<std::string> given_up_;       ///< ids of acts that have waited for too long, of this batch
  DailyActs refused_acts_;
  std::map<std::string, DailyActs> taken_acts_;                       ///< by sort: asset and kind
  std::map<std::string, std::vector<OperatorAct>> acts_of_last_day_;  ///< of forgotten assets
  std::vector<OperatorAct> acts_;                                     ///< of the running batch
  std::vector<Message> records_;                                      ///< of the running batch: own act_records
  bool waits_for_acts_ = false;  ///< the journal is new, and acts come before all else
  std::deque<std::pair<Message, std::chrono::steady_clock::time_point>> told_records_;  ///< not yet in line, since when
  std::vector<Message> said_meanwhile_;             ///< by people, to this service itself
  std::map<std::string, std::string> standing_;     ///< advisory_id of the advice that stands, by asset
  AuditAnchor last_act_;                            ///< of the own record
  std::map<std::string, AuditAnchor> heard_acts_;   ///< the last of each other service, as kept
  std::vector<AuditAnchor> new_anchors_;            ///< not yet kept
  bool is_new_ = false;                             ///< the journal, and not yet compared with others' records
  std::set<std::string> first_heard_;               ///< services that were heard since the start
  std::set<std::string> compared_;                  ///< whose records the journal was compared with before
  std::string has_older_acts_;                      ///< of them, one whose record began before the own journal
  std::string has_unrecorded_acts_;                 ///< likewise, and of an earlier version that keeps no act_record
  std::string has_read_more_;                       ///< one that knows of a journal before the own one
  std::map<std::string, std::string> first_names_;  ///< of others that had written something, by topic_of_name
  std::set<std::string> new_names_;                 ///< of those, the topics that are not yet kept
  std::optional<std::string> set_back_before_;      ///< one that read more than the own journal has written
  bool tells_of_set_back_ = false;
  std::set<std::string> has_read_own_;  ///< services that have said so since the start, and no more than was written
  std::vector<LaneResult> results_;     ///< not yet in the journal
  Outbox outbox_;
  std::map<Key, std::uint64_t> committed_;    ///< positions, as far as they are kept in the journal
  std::set<Key> kept_streams_;                ///< those
  std::map<Key, std::uint64_t> uncommitted_;  ///< positions of the running batch
  LatestOutputs latest_;
  std::set<std::string> forgotten_;  ///< assets whose past was not recalled yet
  std::deque<std::string> to_recall_;
  struct Remembered {
    std::size_t outputs = 0;
    std::chrono::steady_clock::time_point used{};  ///< the last time
  };
  std::map<std::string, Remembered> remembered_;  ///< assets whose past their layers have, once it was recalled
  std::size_t outputs_remembered_ = 0;            ///< outputs, of all of them together
  std::map<std::string, std::chrono::steady_clock::time_point> asleep_;  ///< recalled once, and forgotten since
  std::deque<std::pair<std::string, std::chrono::steady_clock::time_point>> fell_asleep_;  ///< in that order
  std::chrono::steady_clock::time_point forget_next_{};     ///< where nothing more could be, not before
  std::map<std::string, std::vector<PastAct>> past_acts_;   ///< of forgotten assets
  bool all_checked_ = false;                                ///< of the journal's outputs
  std::chrono::steady_clock::time_point look_back_next_{};  ///< under load, not before
  ResendQueue resends_;
  Admission admission_;
  struct Reader {
    std::map<Topic, std::uint64_t> read;  ///< of the own streams
    std::chrono::steady_clock::time_point heard{};
  };
  std::map<std::string, Reader> readers_;  ///< by service
  bool took_local_ = false;                ///< of the running batch: inputs that came from no bus
  std::optional<std::chrono::steady_clock::time_point> full_since_;            ///< the bus had more after each take
  std::chrono::steady_clock::time_point asked_{};                              ///< last look at what is missing
  std::map<std::string, std::chrono::steady_clock::time_point> behind_since_;  ///< assets of which more is to come
  std::map<std::string, bool> replaying_;  ///< by asset: its last input was played back
  std::string last_error_;                 ///< with its time
  Alarms alarms_;
  std::map<std::string, std::map<std::string, Alarms::Steady>> acts_waiting_;  ///< by asset and id: since when
  std::vector<RefusedTest> refused_tests_;                                     ///< the newest last
  std::vector<std::pair<ServiceAlarm, bool>> changed_refused_tests_;  ///< not yet in the journal: whether it stands
  std::optional<AlarmDesk> desk_;
  RecalledAlarmActs recalled_;
  ServiceStatus told_at_desk_;  ///< its part of the heartbeat
  ClockWatch clock_watch_;
  ClockReading clock_reading_;   ///< at the last look
  std::int64_t started_ns_ = 0;  ///< as the heartbeat says it
  StrangerWatch strangers_;
  Retention retention_;
  struct KeptSamples {
    std::uint64_t looked_at = 0;        ///< up to here samples have gone
    std::vector<Journal::Kept> needed;  ///< but for these
  };
  std::map<Topic, KeptSamples> kept_samples_;
  std::chrono::steady_clock::time_point next_retention_{};
  std::vector<SetAside> set_aside_;
  std::map<std::string, std::set<Journal::Test>> set_aside_elsewhere_;  ///< by the service that did so
  std::uint64_t waiting_in_vain_ = 0;                                   ///< open inputs of those tests
  std::chrono::steady_clock::time_point started_{};
  std::chrono::steady_clock::time_point last_second_{};
  std::chrono::steady_clock::time_point last_work_{};  ///< when the last batch began
  bool holds_memory_ = false;                          ///< of work done since memory was given back
  AssetLanes lanes_;
  std::unique_ptr<Heartbeat> heartbeat_;
};

}  // namespace sealwatch
