// `sealwatch show`: a message by its id, and what it was concluded from, down to the waveform.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <set>

#include "sealwatch/core/recording.hpp"
#include "sealwatch/core/text.hpp"
#include "sealwatch/message/outside.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/message_words.hpp"
#include "services/cli/provenance_tree.hpp"
#include "services/cli/session.hpp"
#include "services/cli/state_journals.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

namespace fs = std::filesystem;

/// From the last conclusion of a test to the first: what a PST id alone stands for.
constexpr std::array kFromTheEnd = {Topic::advisory,      Topic::remaining_life, Topic::leakage_estimate,
                                    Topic::health_report, Topic::state_report,   Topic::test_features,
                                    Topic::test_window};
constexpr std::string_view kRecommendation = "recommendation/";  ///< how the id of an advisory begins
constexpr std::size_t kNearest = 3;
constexpr std::size_t kShortestBeginning = 4;  ///< characters of a PST id that may stand for it

std::string topic_name(Topic topic) { return std::string(name_of(topic)); }

/// Ids that `name` may stand for, the likeliest first: itself, a test's last conclusion, an advisory's id.
std::vector<std::string> meanings_of(const std::string& name) {
  std::vector<std::string> ids{name};
  for (const Topic topic : kFromTheEnd) ids.push_back(topic_name(topic) + "/" + name);
  if (name.starts_with(kRecommendation)) ids.push_back("advisory/" + name.substr(kRecommendation.size()));
  return ids;
}

/// The known ids that look most like `name`.
Result<std::string> advice_for(const std::string& name, StateJournals& journals) {
  std::vector<std::pair<std::size_t, std::string>> known;
  for (std::size_t index = 0; index < EnumNames<Topic>::kNames.size(); ++index) {
    const auto topic = static_cast<Topic>(index);
    if (topic == Topic::sample_block && !name.starts_with(topic_name(topic))) continue;
    if (writer_of(topic).empty() || journals.unread(topic_name(topic)) != nullptr) continue;
    const auto ids = journals.ids(topic);
    if (!ids) return fail(ids.error());
    for (const std::string& id : *ids) known.emplace_back(edit_distance(name, id), id);
  }
  std::ranges::sort(known);
  std::string advice;
  for (std::size_t k = 0; k < std::min(kNearest, known.size()); ++k)
    if (known[k].first <= name.size() / 2) advice += (advice.empty() ? "the nearest are " : ", ") + known[k].second;
  if (!advice.empty()) return advice;
  if (journals.unread(topic_name(Topic::advisory)) != nullptr) return std::string("give the id of a message or a test");
  const auto assets = journals.assets(Topic::advisory);
  if (!assets) return fail(assets.error());
  for (const std::string& asset : *assets) text::add_to_list(advice, asset);
  return "give the id of a message, of a test (PST id), or an asset for its newest advisory; assets here: " +
         (advice.empty() ? "none" : advice);
}

/// Nothing of this name was found: it may be in a journal that cannot be looked into.
Error not_found(const std::string& name, bool received, const std::string& advice, const StateJournals& journals) {
  if (const Error* unread = journals.unread(name)) return *unread;
  Error error{.file = journals.place(), .place = {}, .value = name, .rule = {}, .advice = advice};
  const auto topic = value_of<Topic>(name.substr(0, name.find('/')));
  if (received && topic && !writer_of(*topic).empty()) {
    error.rule = "was received here, and the journal of " + writer_of(*topic) + " does not hold it";
    error.advice = "was that journal begun anew? open what was concluded from it";
  } else if (received) {
    error.rule = "came from outside: of such messages only the id is kept";
    error.advice = "open what was concluded from it";
  } else {
    error.rule = journals.unread().empty() ? "is not a message, test or asset in these journals"
                                           : "is in none of the journals that could be looked into";
  }
  if (!received)
    for (const auto& [service, unread] : journals.unread())
      error.rule.append("; not looked into: ").append(unread.file).append(" ").append(unread.rule);
  return error;
}

/// The first of `name`'s meanings that is kept; "": none is.
Result<std::string> kept_meaning(const std::string& name, StateJournals& journals) {
  for (const std::string& id : meanings_of(name)) {
    const auto kept = journals.find(id);
    if (!kept) return fail(kept.error());
    if (*kept) return id;
  }
  return std::string();
}

/// PST ids that begin with `name`, which is shorter.
Result<std::set<std::string>> tests_that_begin(const std::string& name, StateJournals& journals) {
  std::set<std::string> tests;
  if (name.size() < kShortestBeginning || name.find('/') != std::string::npos) return tests;
  for (const Topic topic : kFromTheEnd) {
    if (journals.unread(topic_name(topic)) != nullptr) continue;
    const auto ids = journals.ids(topic);
    if (!ids) return fail(ids.error());
    const std::string begin = topic_name(topic) + "/" + name;
    for (const std::string& id : *ids)
      if (id.starts_with(begin) && id.find('/', begin.size()) == std::string::npos)
        tests.insert(id.substr(topic_name(topic).size() + 1));
  }
  return tests;
}

Error ambiguous(const std::string& name, const std::set<std::string>& tests, const StateJournals& journals) {
  std::string newest;
  auto test = tests.rbegin();
  for (std::size_t k = 0; k < kNearest && test != tests.rend(); ++k, ++test) newest += (k > 0 ? ", " : "") + *test;
  return {.file = journals.place(),
          .place = {},
          .value = name,
          .rule = "is how the ids of " + std::to_string(tests.size()) + " tests begin",
          .advice = "give more of the id; the newest are " + newest};
}

/// The id that is meant; an Error where none is. Of a test the beginning of its id will do, if no other begins so.
Result<std::string> resolve(const std::string& name, StateJournals& journals) {
  if (auto id = kept_meaning(name, journals); !id || !id->empty()) return id;
  if (journals.unread(topic_name(Topic::advisory)) == nullptr) {
    const auto of_asset = journals.ids(Topic::advisory, name);
    if (!of_asset) return fail(of_asset.error());
    if (!of_asset->empty()) return of_asset->back();
  }
  const auto received = journals.received(name);
  if (!received) return fail(received.error());
  const auto tests = tests_that_begin(name, journals);
  if (!tests) return fail(tests.error());
  if (tests->size() > 1) return fail(ambiguous(name, *tests, journals));
  if (tests->size() == 1) return kept_meaning(*tests->begin(), journals);
  const auto advice = advice_for(name, journals);
  if (!advice) return fail(advice.error());
  return fail(not_found(name, *received, *advice, journals));
}

/// A recording is two files, and neither may take the place of one that is there: FILE.yaml may be somebody's asset.
Status free_for_recording(const std::string& file) {
  const auto refuse = [](const std::string& name, std::string rule, std::string advice) {
    return fail(
        Error{.file = name, .place = "--csv", .value = {}, .rule = std::move(rule), .advice = std::move(advice)});
  };
  const fs::path path(file);
  if (path.extension() != ".csv")
    return refuse(file, "must end in .csv", "for example --csv " + fs::path(file).replace_extension(".csv").string());
  std::error_code none;
  for (const fs::path& one : {path, fs::path(path).replace_extension(".yaml")})
    if (fs::symlink_status(one, none).type() != fs::file_type::not_found)
      return refuse(one.string(), "is there already and is left as it is",
                    "give another name: a recording is a .csv and its sidecar, a .yaml of the same name");
  return {};
}

Status write_waveform(const SourceNode& root, const std::string& file) {
  const TestWindow* window = window_of(root);
  if (window != nullptr && is_expired(window->header.producer))
    return fail(Error{.file = {},
                      .place = "--csv",
                      .value = window->header.message_id,
                      .rule = "no longer has samples: retention has dropped them",
                      .advice = "its conclusions are there without them; key retention of the configuration says how "
                                "long samples are kept"});
  if (window == nullptr || window->samples.time_s.empty())
    return fail(Error{.file = {},
                      .place = "--csv",
                      .value = root.message_id,
                      .rule = "has no waveform behind it here",
                      .advice = "its test_window is in data_manipulation's journal"});
  Recording recording{.file = file,
                      .recording_id = window->recording_id,
                      .asset_id = window->asset_id,
                      .start_time = {},
                      .content_hash = {},
                      .note = "samples of " + window->header.message_id,
                      .samples = window->samples};
  if (const auto kind = value_of<TestKind>(window->test_kind)) recording.test = *kind;
  if (window->header.event_time_known) recording.start_time = UtcTime{window->header.event_time_ns};
  return write_recording_csv(recording, file);
}

int complained(const Error& error) {
  complain(error);
  return kBadInput;
}

}  // namespace

int run_show(const ShowOptions& options) {
  if (options.id.empty())
    return complained(
        Error{.file = {},
              .place = "id",
              .value = {},
              .rule = "must not be empty",
              .advice = "give the id of a message, of a test (PST id), or an asset for its newest advisory"});
  if (!options.csv.empty())
    if (const Status is_free = free_for_recording(options.csv); !is_free) return complained(is_free.error());
  std::optional<StateJournals> journals = StateJournals::open(options.state_directory, options.config);
  if (!journals) return kBadInput;
  const Result<std::string> id = resolve(options.id, *journals);
  if (!id) return complained(id.error());
  const LookUp look_up = [&](const std::string& message_id) -> Result<Looked> {
    auto kept = journals->find(message_id);
    if (!kept) return fail(kept.error());
    const Error* unread = journals->unread(message_id);
    if (!*kept) return Looked{nullptr, unread == nullptr ? "" : unread->file + ": " + unread->rule};
    return Looked{std::make_shared<const Message>(std::move((*kept)->message)), (*kept)->place};
  };
  const Result<SourceNode> tree = provenance_tree(*id, look_up);
  if (!tree) return complained(tree.error());
  if (!options.csv.empty())
    if (const Status written = write_waveform(*tree, options.csv); !written) return complained(written.error());
  std::printf("%s", options.json ? (tree_json(*tree) + "\n").c_str() : tree_text(*tree).c_str());
  if (options.csv.empty() && !options.json)
    std::printf("(sealwatch show ID opens each of them; --json: all it says; --csv FILE: the waveform of the test)\n");
  if (!options.csv.empty() && !options.json)
    std::printf("wrote %s: the waveform of the test, as all layers used it\n", options.csv.c_str());
  return kOk;
}

}  // namespace sealwatch::cli
