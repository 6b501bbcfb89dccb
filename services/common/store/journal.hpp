// The journal of one service: what it received and what it concluded, kept before anything is published.
//
// Tables (docs/operations.md): inputs and outputs with their messages as exact JSON, positions of the streams that were
// read, quarantine with what is set aside and why, acts with what people did, meta with the schema's version, the service and its writer id. All changes happen between begin and commit, so
// that a process killed at any instant leaves whole batches only.
//
// The connection string is SOCI's: "sqlite3://FILE" (write-ahead log, one file for each service) or
// "postgresql://dbname=... options='-c search_path=SERVICE'" (one schema for each service).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/message/topics.hpp"
#include "services/common/store/audit_trail.hpp"

namespace sealwatch {

/// A connection string as it may be shown (connection_string.hpp).
[[nodiscard]] std::string without_password(const std::string& connection);

/// How a numbered message stands to what was received.
enum class KnownInput {
  no,
  same,            ///< by its id, under this number or from another writer
  other_sequence,  ///< its writer had sent it under another number
};

/// A message on which a layer failed. It and all other inputs of its test are set aside: kept, and not given to the
/// layer again until somebody asks for that.
struct SetAside {
  std::string message_id;
  std::string topic;
  std::string asset_id;
  std::string pst_id;  ///< "" for a message that belongs to no test: then it alone is set aside
  std::int64_t since_ns = 0;
  std::string reason;
};

/// awaiting: an act that is kept until a second person confirms it; ahead: until what it means is known.
enum class InputState { open, consumed, set_aside, awaiting, ahead };

/// What a committed batch is safe from at once. A power cut takes back the last batches that are safe from kills alone,
/// always the newest first, until they are on the disk (Journal::to_disk).
enum class Survives { kills, power_cuts };

class Journal {
 public:
  /// Opens or creates the journal of `service`. The writer id is made at creation and stays with the journal: a deleted
  /// journal comes back as a new writer, whose streams start at 1 again.
  [[nodiscard]] static Result<Journal> open(const std::string& connection, const std::string& service);
  /// Whether a journal could be opened there, without making one: the file's directory, the server's answer.
  [[nodiscard]] static Status check(const std::string& connection);
  /// Whether it is a connection string of a database that is supported.
  [[nodiscard]] static Status check_kind(const std::string& connection);
  /// The same text for connection strings of the same place: a file's absolute path, or the server's string.
  [[nodiscard]] static std::string place_of(const std::string& connection);
  /// The file of a connection to SQLite: FILE of "sqlite3://FILE" or "sqlite3://dbname=FILE timeout=5".
  [[nodiscard]] static std::string file_of(const std::string& connection);
  ~Journal();
  Journal(Journal&& other) noexcept;
  Journal& operator=(Journal&& other) noexcept;

  [[nodiscard]] const std::string& writer_id() const;

  /// Brings all that was committed before the call to the disk, and says whether it is there. The function may be called
  /// in a thread of its own, while this journal lives.
  [[nodiscard]] std::function<bool()> to_disk() const;

  // Reading. Outputs come back without stamps (writer id, sequence, publishing time) where the layer takes them back,
  // with stamps where they go out.

  using Visitor = std::function<Status(const Message&)>;
  /// Where an output stands: its number in its stream, and when it was concluded.
  struct Place {
    std::uint64_t sequence = 0;
    UtcTime concluded;
  };
  using NumberedVisitor = std::function<Status(const Message&, const Place& place)>;
  /// Whether the last output about a test tells all of it (Layer::tells_all).
  using TellsAll = std::function<bool(const Message& last_of_test)>;
  /// Every output in the order of conclusion, as the layer made it. Those of a test of which one is damaged are left out:
  /// all of that test is concluded again (journal_mend.cpp).
  [[nodiscard]] Status for_each_output(const Visitor& visit);
  /// Every output about one asset, likewise. Of a test of which the last tells all, the others of its topic are left out,
  /// and those of other topics come with their ids and the last one's header alone. What was read from JSON is packed,
  /// and read from there the next time, without the samples of what tells all.
  [[nodiscard]] Status for_each_output_of(const std::string& asset_id, const NumberedVisitor& visit,
                                          const TellsAll& tells_all);
  /// What is packed is read by this version of the program alone.
  void pack_for(const std::string& version);
  /// Where the past of an asset was packed (packed_past.hpp) and had to be read from JSON again: which, and why. Once.
  [[nodiscard]] std::optional<std::string> take_packed_refused();
  /// Assets about which there is an output or an open input, those with open inputs first.
  [[nodiscard]] Result<std::vector<std::string>> assets();
  /// Looks at the next few outputs that were not looked at since the journal was opened; false when there are no more.
  /// An Error where one is not as it was written: opened again, the journal mends it.
  [[nodiscard]] Result<bool> check_some();
  /// Every input that was not consumed, in the order of receipt. `visit` may write to the journal.
  [[nodiscard]] Status for_each_open_input(const Visitor& visit);
  /// Ids of those about one asset.
  [[nodiscard]] Result<std::vector<std::string>> open_inputs_of(const std::string& asset_id);
  /// An input that is kept; none when it was consumed.
  [[nodiscard]] Result<std::optional<Message>> input(const std::string& message_id);
  using Test = std::pair<std::string, std::string>;  // asset and PST id: two assets may give theirs the same ids
  /// How many open inputs are of these tests.
  [[nodiscard]] Result<std::uint64_t> open_inputs_of_tests(const std::set<Test>& tests);
  /// Outputs of one topic's stream, first <= sequence <= last, at most `most`, stamped.
  [[nodiscard]] Result<std::vector<Message>> outputs(Topic topic, std::uint64_t first, std::uint64_t last,
                                                     std::size_t most);
  [[nodiscard]] Result<bool> has_input(const std::string& message_id);
  /// None where there is no input of that id.
  [[nodiscard]] Result<std::optional<std::string>> asset_of_input(const std::string& message_id);
  [[nodiscard]] Result<KnownInput> known_input(const Message& message);
  /// Message id of the last input of this asset that belonged to no stream; "" if there is none.
  [[nodiscard]] Result<std::string> last_unnumbered_input(Topic topic, const std::string& asset_id);
  /// How far each own stream goes, by topic.
  [[nodiscard]] const std::map<Topic, std::uint64_t>& written() const;
  /// How far other writers' streams were read.
  [[nodiscard]] Result<std::vector<StreamPosition>> positions();
  /// Inputs received and not consumed.
  [[nodiscard]] std::uint64_t open_inputs() const;

  /// The latest time at which it is known to have been used before it was opened.
  [[nodiscard]] UtcTime last_used() const;
  /// An Error where its files were removed or replaced meanwhile; begin() looks as well.
  [[nodiscard]] Status is_in_place();

  // Writing, between begin and commit. After an error call rollback.

  [[nodiscard]] Status begin(Survives survives = Survives::kills);
  [[nodiscard]] Status commit();
  void rollback();
  /// Keeps an input; its message only where it was not consumed already.
  [[nodiscard]] Status add_input(const Message& message, UtcTime received, bool consumed);
  /// Likewise, with the stream that it came in.
  [[nodiscard]] Status add_input(const Message& message, const StreamPosition& stream, UtcTime received,
                                 InputState state);
  /// Marks an input as not needed again and drops its message; unknown ids are passed over.
  [[nodiscard]] Status consume(const std::string& message_id);
  /// Numbers and keeps an output and returns it stamped, or nothing when it was concluded before. Beside one of its id that
  /// is another asset's, it is kept under another.
  [[nodiscard]] Result<std::optional<Message>> add_output(Message message, UtcTime publishing_time);
  [[nodiscard]] Status set_position(const StreamPosition& position);
  /// Notes that its writer now sends a known input under this number.
  [[nodiscard]] Status renumber_input(const Message& message);

  /// What the journal takes on its disk, without what is free in it [bytes].
  [[nodiscard]] Result<double> used_bytes();
  /// An output whose samples are kept.
  struct Kept {
    std::uint64_t sequence = 0;
    std::string asset_id;
    std::string pst_id;
    UtcTime concluded;
  };
  /// The last of those of one topic right behind `after` whose samples are dropped, as far as it looks; `after`: none.
  [[nodiscard]] Result<std::uint64_t> dropped_samples(Topic topic, std::uint64_t after);
  /// Those of one topic behind `after`, the oldest first, as far as it looks.
  [[nodiscard]] Result<std::vector<Kept>> kept_samples(Topic topic, std::uint64_t after, std::size_t most);
  /// Drops the samples of an output for ever; all else that it says stays, and its producer says so (is_expired).
  [[nodiscard]] Status expire(Topic topic, std::uint64_t sequence);

  /// What became of alarms, as kept; rows that are not as they were written are left out.
  [[nodiscard]] Result<std::vector<AlarmEntry>> alarms();
  /// Keeps it in the place of an earlier one of the same kind, asset and subject.
  [[nodiscard]] Status keep_alarm(const AlarmEntry& entry);
  [[nodiscard]] Status forget_alarm(const ServiceAlarm& alarm);

  /// Adds what somebody did to the audit trail.
  [[nodiscard]] Result<AuditEntry> record(const OperatorAct& act);

  /// What people did, in the order of receipt.
  [[nodiscard]] Result<std::vector<AuditEntry>> acts();
  /// The last of them; number 0 where there is none.
  [[nodiscard]] Result<AuditAnchor> last_act();
  /// Whether it was made where none was, or none that could be read, and nobody has compared it with others' since.
  [[nodiscard]] Result<bool> is_new();
  [[nodiscard]] Status no_longer_new();
  /// Keeps what another service told of its record; between begin and commit.
  [[nodiscard]] Status keep_anchor(const AuditAnchor& heard);
  [[nodiscard]] Result<std::vector<AuditAnchor>> anchors();

  struct Awaiting {
    Message message;
    UtcTime received;
  };
  /// What waits for a second person, in the order of receipt.
  [[nodiscard]] Result<std::vector<Awaiting>> awaiting();
  struct Ahead {
    std::string message_id;
    std::string asset_id;
    UtcTime received;
  };
  /// Acts that are ahead.
  [[nodiscard]] Result<std::vector<Ahead>> acts_ahead();
  /// Ids of those of one asset, in the order of receipt.
  [[nodiscard]] Result<std::vector<std::string>> acts_ahead(const std::string& asset_id);
  /// Ends the wait of an act that is awaiting or ahead: open or consumed.
  [[nodiscard]] Status end_awaiting(const std::string& message_id, InputState state);
  /// Forgets that such an act came: said again, it is another.
  [[nodiscard]] Status forget_awaiting(const std::string& message_id);

  // The quarantine. It is written between begin and commit; askers write to it from other processes (quarantine_desk.hpp).

  [[nodiscard]] Result<std::vector<SetAside>> quarantine();
  [[nodiscard]] Status set_aside(const SetAside& message);
  /// Opens what was set aside again; the row stays as a record of who asked for it.
  [[nodiscard]] Status release(const SetAside& message);
  /// Ids of what is to be tried again.
  [[nodiscard]] Result<std::vector<std::string>> asked_again();

 private:
  struct Database;
  explicit Journal(std::unique_ptr<Database> database);
  [[nodiscard]] Status for_each_page(const std::string& query, const Visitor& visit);
  std::unique_ptr<Database> database_;
};

}  // namespace sealwatch
