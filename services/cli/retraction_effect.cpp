#include "services/cli/retraction_effect.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <vector>

#include "sealwatch/core/text.hpp"
#include "sealwatch/message/retraction.hpp"
#include "services/cli/state_journals.hpp"
#include "services/common/runtime/operator_acts.hpp"
#include "services/common/store/audit_trail.hpp"
#include "services/data_acquisition/pst_id.hpp"

namespace sealwatch::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// Every service beats once a second; of an asset without tests no remaining life comes.
constexpr std::chrono::milliseconds kListenForTests{1500};
constexpr const char* kPrognosisService = "prognostic_assessment";
constexpr const char* kManipulationService = "data_manipulation";
constexpr std::string_view kEstimateOf = "leakage_estimate/";

/// Writer ids by service: a journal of another one is of other services, which ran here once.
using WritersHeard = std::map<std::string, std::string>;

WritersHeard listen_to_writers(Bus& bus, const std::string& asset_id, KnownTests& known) {
  constexpr std::array kLife = {Topic::remaining_life};
  WritersHeard writers;
  if (!bus.subscribe(kLife) || !bus.subscribe_service_topics()) return writers;
  const auto enough = [&] {
    return known.life && writers.contains(kPrognosisService) && writers.contains(kManipulationService);
  };
  for (const auto end = Clock::now() + kListenForTests; Clock::now() < end && !enough();)
    for (const BusItem& item : bus.receive(std::chrono::milliseconds(50))) {
      if (const auto* status = std::get_if<ServiceStatus>(&item)) writers[status->service] = status->writer_id;
      if (const auto* message = std::get_if<Message>(&item); message != nullptr && asset_of(*message) == asset_id)
        if (const auto* life = std::get_if<RemainingLife>(message)) known.life = *life;
    }
  return writers;
}

/// Of one topic, of which each test has a message; false where they cannot be read.
bool take_tests(JournalReader& journal, Topic topic, const std::string& asset_id, KnownTests& known) {
  const auto messages = journal.outputs(topic, asset_id);
  if (!messages) return false;
  for (const Message& message : *messages) {
    const Header& header = header_of(message);
    if (header.pst_id.empty()) continue;
    known.tests[header.pst_id] = header.event_time_known ? std::optional(UtcTime{header.event_time_ns}) : std::nullopt;
  }
  return true;
}

/// Also those of which the record of acts was lost: what answered them names them.
bool take_acts(JournalReader& journal, const std::string& connection, const std::string& asset_id, KnownTests& known) {
  const auto acts = read_audit_trail(connection, kPrognosisService);
  const auto lives = journal.outputs(Topic::remaining_life, asset_id);
  if (!acts || !lives) return false;
  std::set<std::string> ids;
  for (const AuditEntry& entry : *acts)
    if (entry.act.asset_id == asset_id && (is_taken(entry.act.outcome) || entry.act.outcome.starts_with("waits")))
      ids.insert(entry.act.subject);
  for (const Message& life : *lives) ids.insert(header_of(life).source_ids.begin(), header_of(life).source_ids.end());
  for (const std::string& id : ids)
    if (is_replacement_id(id) || (is_retraction_id(id) && retraction_of(asset_id, id))) known.in_force.insert(id);
  for (const std::string& id : ids)
    if (const auto retraction = retraction_of(asset_id, id)) known.in_force.erase(retraction->withdrawn_id);
  return true;
}

bool read_journals(const WritersHeard& writers, const RetractOptions& options, KnownTests& known) {
  const auto connections = journal_connections({}, options.config);
  if (!connections) return false;
  for (const auto& [service, topic] :
       {std::pair{kManipulationService, Topic::test_features}, std::pair{kPrognosisService, Topic::leakage_estimate}}) {
    const auto connection = connections->find(service);
    const auto writer = writers.find(service);
    if (connection == connections->end() || writer == writers.end() || is_missing(connection->second)) return false;
    auto journal = JournalReader::open(connection->second, service);
    if (!journal || journal->writer_id() != writer->second) return false;
    if (!take_tests(*journal, topic, options.asset_id, known)) return false;
    if (service == kPrognosisService && !take_acts(*journal, connection->second, options.asset_id, known)) return false;
  }
  return true;
}

/// The tests from which a remaining life was concluded.
std::vector<std::string> estimated_tests(const RemainingLife& life) {
  std::vector<std::string> tests;
  for (const std::string& id : life.header.source_ids)
    if (id.starts_with(kEstimateOf)) tests.push_back(id.substr(kEstimateOf.size()));
  std::ranges::sort(tests);
  return tests;
}

/// Of those that are known, the one that may be meant, or the latest.
std::string advice_of_tests(const KnownTests& known, const RetractOptions& options) {
  std::vector<std::string> tests = known.life ? estimated_tests(*known.life) : std::vector<std::string>();
  if (!options.withdraw.empty()) return "`sealwatch audit` shows what was taken";
  if (known.complete) tests.clear();
  for (const auto& [pst_id, time] : known.tests) tests.push_back(pst_id);
  if (tests.empty()) return "no test of it is known";
  std::string near = nearest(options.pst_id, tests);
  return near.empty() ? "the latest is " + *std::ranges::max_element(tests) : "did you mean '" + near + "'?";
}

Error error_about(const KnownTests& known, const RetractOptions& options, const std::string& rule) {
  const bool one = !options.pst_id.empty(), since = !options.since.empty();
  return Error{.file = {},
               .place = one     ? "--test"
                        : since ? "--since"
                                : "--withdraw",
               .value = one     ? options.pst_id
                        : since ? options.since
                                : options.withdraw,
               .rule = rule,
               .advice = advice_of_tests(known, options)};
}

/// Of this asset, by its form: one that another service still holds is no longer in a journal that was lost.
bool may_be_an_act(const RetractOptions& options) {
  return is_replacement_id(options.withdraw) ||
         (is_retraction_id(options.withdraw) && retraction_of(options.asset_id, options.withdraw));
}

/// What the ids of the asset's tests begin with.
std::string begin_of_ids(const std::string& asset_id) {
  RawSamples test;
  test.asset_id = asset_id;
  const std::string id = make_pst_id(test);
  return id.substr(0, id.rfind("undated"));
}

}  // namespace

KnownTests known_tests(Session& session, const RetractOptions& options) {
  KnownTests known;
  const WritersHeard writers = listen_to_writers(*session.bus, options.asset_id, known);
  known.complete = read_journals(writers, options, known);
  return known;
}

std::optional<Error> objection(const KnownTests& known, const RetractOptions& options) {
  const std::string begin = begin_of_ids(options.asset_id);
  if (!options.pst_id.empty() && !options.pst_id.starts_with(begin))
    return error_about(known, options,
                       "is not a test of " + options.asset_id + ", whose ids begin with '" + begin + "'");
  if (!known.complete) return std::nullopt;
  if (!options.pst_id.empty() && !known.tests.contains(options.pst_id))
    return error_about(known, options, "is not a test of " + options.asset_id + " that the services know");
  if (!options.withdraw.empty() && !known.in_force.contains(options.withdraw) && !may_be_an_act(options))
    return error_about(known, options,
                       "is neither a retraction nor a replacement of " + options.asset_id + " in force");
  return std::nullopt;
}

void hear(const RemainingLife& life, const std::string& act_id, KnownTests& known,
          std::optional<RemainingLife>& answer) {
  if (answer) return;
  const bool is_answer = std::ranges::count(life.header.source_ids, act_id) > 0;
  (is_answer ? answer : known.life) = life;
}

std::optional<Error> objection(const KnownTests& known, const RemainingLife& answer, const RetractOptions& options) {
  // What is known to count changes something, in another layer perhaps. Of a date, tests that were set aside may be meant.
  const bool counts = !options.pst_id.empty() || known.in_force.contains(options.withdraw);
  if (!known.life || (known.complete && counts)) return std::nullopt;
  const RemainingLife& before = *known.life;
  const bool same = estimated_tests(before) == estimated_tests(answer) &&
                    before.replacement_known == answer.replacement_known && before.replaced_ns == answer.replaced_ns &&
                    before.tests_since_replacement == answer.tests_since_replacement;
  if (!same) return std::nullopt;
  return error_about(known, options,
                     "was received, and changes nothing: the remaining life of " + options.asset_id +
                         " is concluded from the same " + std::to_string(answer.tests_since_replacement) +
                         " tests as before");
}

}  // namespace sealwatch::cli
