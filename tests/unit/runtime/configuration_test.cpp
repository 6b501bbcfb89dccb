// The configuration as a whole: defaults, and every fault with file, line, key, value, rule and advice.
#include "services/common/runtime/configuration_loader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/runtime/yaml_place.hpp"

namespace sealwatch::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> faults(const YamlPlace& place, const std::string& path) {
  const auto configuration = load_configuration(path);
  if (configuration) return {};
  std::vector<std::string> found;
  for (const Error& error : configuration.error()) found.push_back(place.bare(error.describe()));
  return found;
}

struct BadCase {
  const char* name;
  const char* yaml;
  const char* message;
};

class BadConfiguration : public ::testing::TestWithParam<BadCase> {};

TEST_P(BadConfiguration, IsNamed) {
  const YamlPlace place;
  EXPECT_THAT(faults(place, place.write("sealwatch.yaml", GetParam().yaml)), ElementsAre(GetParam().message));
}

const BadCase kBadCases[] = {
    {"unknown_key", "domain: 1\nstate_directroy: x\n",
     "sealwatch.yaml: line 2, key state_directroy: 'state_directroy': is not a known key; did you mean "
     "'state_directory'?"},
    {"unknown_service", "services:\n  state_detecton: {}\n",
     "sealwatch.yaml: line 2, key services.state_detecton: 'state_detecton': is not a known key; did you mean "
     "'state_detection'?"},
    {"unknown_key_of_service", "services: {state_detection: {enable: true}}\n",
     "sealwatch.yaml: line 1, key services.state_detection.enable: 'enable': is not a known key; did you mean "
     "'enabled'?"},
    {"unknown_topic", "topics:\n  advisories: {keep_all: true}\n",
     "sealwatch.yaml: line 2, key topics.advisories: 'advisories': is not a known key; did you mean 'advisory'?"},
    {"domain_too_large", "domain: 233\n",
     "sealwatch.yaml: line 1, key domain: '233': must be a whole number from 0 to 232"},
    {"domain_broken", "domain: 1.5\n",
     "sealwatch.yaml: line 1, key domain: '1.5': must be a whole number from 0 to 232"},
    {"deadline", "services: {state_detection: {deadline_s: 0}}\n",
     "sealwatch.yaml: line 1, key services.state_detection.deadline_s: '0': must be a number of seconds from 0.1 to "
     "86400"},
    {"not_a_bool", "services: {state_detection: {enabled: 1}}\n",
     "sealwatch.yaml: line 1, key services.state_detection.enabled: '1': must be true or false"},
    {"level", "logging:\n  level: inf\n",
     "sealwatch.yaml: line 2, key logging.level: 'inf': is not known; did you mean 'info'?"},
    {"latin_1", "sites: [{site: a, campaigns: [{label: f\xF6rsommar 2031, start: 2031-06-01}]}]\n",
     "sealwatch.yaml: line 1, key sites[0].campaigns[0].label: 'f\\xF6rsommar 2031': must be UTF-8 without control "
     "characters or invisible ones; save the file as UTF-8"},
    {"a_path_that_ends_early", "state_directory: \"a\\0b\"\n",
     "sealwatch.yaml: line 1, key state_directory: 'a\\x00b': must be UTF-8 without control characters or invisible "
     "ones; save the file as UTF-8"},
    {"rotation", "logging: {rotate_at_MB: 0}\n",
     "sealwatch.yaml: line 1, key logging.rotate_at_MB: '0': must be a number above 0"},
    {"lifespan", "topics: {advisory: {lifespan_s: -1}}\n",
     "sealwatch.yaml: line 1, key topics.advisory.lifespan_s: '-1': must be a number, 0 or above"},
    {"journal", "services: {state_detection: {journal: x.db}}\n",
     "sealwatch.yaml: line 1, key services.state_detection.journal: 'x.db': must be a connection string of SQLite or "
     "PostgreSQL; write sqlite3://FILE or postgresql://dbname=NAME"},
    {"journal_of_another_database", "services:\n  state_detection: {journal: \"mysql://db=x password=y\"}\n",
     "sealwatch.yaml: line 2, key services.state_detection.journal: 'mysql://db=x password=***': must be a connection "
     "string of SQLite or PostgreSQL; write sqlite3://FILE or postgresql://dbname=NAME"},
    {"journal_of_two_services",
     "services:\n  data_manipulation: {journal: \"sqlite3:///var/j.db\"}\n"
     "  state_detection:\n    journal: sqlite3:///var/lib/../j.db\n",
     "sealwatch.yaml: line 4, key services.state_detection.journal: 'sqlite3:///var/lib/../j.db': is the journal of "
     "data_manipulation too: each service has one of its own; give each service its own file or, in PostgreSQL, its "
     "own schema"},
    {"lead_time", "sites: [{site: a, booking_lead_time_months: 121}]\n",
     "sealwatch.yaml: line 1, key sites[0].booking_lead_time_months: '121': must be a number of months from 0 to 120"},
    {"campaign_without_label", "sites: [{site: a, campaigns: [{start: 2017-06-01}]}]\n",
     "sealwatch.yaml: line 1, key sites[0].campaigns[0].label: must be given: advice names the campaign by it"},
    {"campaign_with_empty_label", "sites: [{site: a, campaigns: [{start: 2017-06-01, label: \"\"}]}]\n",
     "sealwatch.yaml: line 1, key sites[0].campaigns[0].label: must be given: advice names the campaign by it"},
    {"campaigns_on_one_day",
     "sites:\n  - site: a\n    campaigns:\n      - {start: 2017-06-01, label: x}\n"
     "      - {start: 2017-06-01T12:00:00Z, label: y}\n",
     "sealwatch.yaml: line 5, key sites[0].campaigns[1].start: '2017-06-01': is the day of campaign 'x' already; take "
     "one of them out, or correct its day"},
    {"costs_incomplete", "sites: [{site: a, costs: {planned: 1, after_failure: 5, failed_month: 2}}]\n",
     "sealwatch.yaml: line 1, key sites[0].costs.unused_month: must be given: costs are compared with each other; "
     "write 0 where there is none"},
    {"failure_rate", "sites: [{site: a, safety: {dangerous_undetected_per_hour: 1.5}}]\n",
     "sealwatch.yaml: line 1, key sites[0].safety.dangerous_undetected_per_hour: '1.5': must be a rate per hour above "
     "0, at most 1e-3"},
    {"recordings_of_another_service", "services: {state_detection: {recordings_directory: in}}\n",
     "sealwatch.yaml: line 1, key services.state_detection.recordings_directory: 'recordings_directory': is not a "
     "known key; known are: enabled, journal, deadline_s"},
    {"forecast_method", "services:\n  prognostic_assessment:\n    forecasters:\n      - {method: ols_drifft}\n",
     "sealwatch.yaml: line 4, key services.prognostic_assessment.forecasters[0].method: 'ols_drifft': is not known; "
     "did "
     "you mean 'ols_drift'?"},
    {"forecaster_without_method", "services: {prognostic_assessment: {forecasters: [{window_months: 36}]}}\n",
     "sealwatch.yaml: line 1, key services.prognostic_assessment.forecasters[0].method: must be given"},
    {"forecast_window", "services: {prognostic_assessment: {forecasters: [{method: ols, window_months: 0}]}}\n",
     "sealwatch.yaml: line 1, key services.prognostic_assessment.forecasters[0].window_months: '0': must be a whole "
     "number of months from 2 to 600"},
    {"advice_key", "services: {advisory_generation: {advice: {easing_test: 3}}}\n",
     "sealwatch.yaml: line 1, key services.advisory_generation.advice.easing_test: 'easing_test': is not a known key; "
     "did you mean 'easing_tests'?"},
    {"advice_value", "services:\n  advisory_generation:\n    advice: {largest_failure_probability: 0.9}\n",
     "sealwatch.yaml: line 3, key services.advisory_generation.advice.largest_failure_probability: '0.900000': must be "
     "above 0, at most 0.5"},
    {"advice_of_another_service", "services: {state_detection: {advice: {}}}\n",
     "sealwatch.yaml: line 1, key services.state_detection.advice: 'advice': is not a known key; known are: enabled, "
     "journal, deadline_s"},
    {"site_twice", "sites:\n  - site: a\n  - site: a\n",
     "sealwatch.yaml: line 3, key sites[1].site: 'a': is there twice; name each site once"},
    {"site_without_name", "sites:\n  - booking_lead_time_months: 3\n",
     "sealwatch.yaml: line 2, key sites[0].site: must be given"},
    {"campaign_date", "sites:\n  - site: a\n    campaigns:\n      - {label: x, start: 2017-13-01}\n",
     "sealwatch.yaml: line 4, key sites[0].campaigns[0].start: '2017-13-01': must be a UTC time in ISO 8601; write it "
     "as 2031-04-12T03:00:00Z"},
    {"campaign_without_date", "sites: [{site: a, campaigns: [{label: x}]}]\n",
     "sealwatch.yaml: line 1, key sites[0].campaigns[0].start: must be given"},
    {"not_a_list", "sites: north\n", "sealwatch.yaml: line 1, key sites: 'north': must be a list"},
    {"not_a_map", "logging: loud\n",
     "sealwatch.yaml: line 1, key logging: 'loud': must be a mapping of keys to values"},
    {"senders", "senders: [[a]]\n",
     "sealwatch.yaml: line 1, key senders: must be a list of names: the source_id of raw samples"},
    {"second_person", "operator_acts: {confirmed_by_two: true}\n",
     "sealwatch.yaml: line 1, key operator_acts.confirmed_by_two: 'confirmed_by_two': is not a known key; did you mean "
     "'confirmed_by_second'?"},
    {"retention", "retention: {days: 0.5}\n",
     "sealwatch.yaml: line 1, key retention.days: '0.5': must be 1 or more; leave it out to keep samples for "
     "ever"},
    {"root_not_a_map", "- a\n- b\n", "sealwatch.yaml: line 1: must be a mapping of keys to values"},
    {"twice", "domain: 1\ndomain: 2\n", "sealwatch.yaml: line 2, key domain: 'domain': stands twice; keep one of them"},
    {"empty_state_directory", "state_directory: \"\"\n",
     "sealwatch.yaml: line 1, key state_directory: must not be empty"},
    {"asset_missing", "assets: [none.yaml]\n", "none.yaml: cannot be opened: No such file or directory"},
};

TEST(Configuration, NamesItsSendersAndAsksForNoSecondPersonWhereItSaysSo) {
  const YamlPlace place;
  const auto plain = load_configuration(place.write("sealwatch.yaml", "domain: 1\n"), {});
  ASSERT_TRUE(plain);
  EXPECT_TRUE(plain->senders.empty());
  EXPECT_TRUE(plain->acts_confirmed_by_second) << "what lowers an advisory takes two";
  const auto alone = load_configuration(
      place.write("sealwatch.yaml", "senders: [MCS-1, MCS-2]\noperator_acts: {confirmed_by_second: false}\n"), {});
  ASSERT_TRUE(alone);
  EXPECT_THAT(alone->senders, ElementsAre("MCS-1", "MCS-2"));
  EXPECT_FALSE(alone->acts_confirmed_by_second);
}

TEST(Configuration, KeepsSamplesForEverUnlessItSaysOtherwise) {
  const YamlPlace place;
  const auto plain = load_configuration(place.write("sealwatch.yaml", "domain: 1\n"), {});
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->retention.days, 0.0);
  EXPECT_EQ(plain->retention.megabytes, 0.0);
  const auto bounded = load_configuration(place.write("sealwatch.yaml",
                                                      "retention: {days: 400, megabytes: 20000}\n"
                                                      "services: {data_acquisition: {recordings_retention: {days: "
                                                      "30, megabytes: 50}}}\n"),
                                          {});
  ASSERT_TRUE(bounded);
  EXPECT_EQ(bounded->retention.days, 400.0);
  EXPECT_EQ(bounded->retention.megabytes, 20'000.0);
  EXPECT_EQ(bounded->services.at("data_acquisition").recordings_retention.days, 30.0);
  EXPECT_EQ(bounded->services.at("data_acquisition").recordings_retention.megabytes, 50.0);
}

TEST(Configuration, SaysWhatIsDoneWithWhomItDoesNotName) {
  const YamlPlace place;
  const auto plain = load_configuration(place.write("sealwatch.yaml", "domain: 1\n"), {});
  ASSERT_TRUE(plain);
  EXPECT_FALSE(plain->refuses_unknown_assets);
  EXPECT_TRUE(plain->refuses_unknown_writers);
  const auto other =
      load_configuration(place.write("sealwatch.yaml", "unknown_assets: refuse\nunknown_writers: take\n"), {});
  ASSERT_TRUE(other);
  EXPECT_TRUE(other->refuses_unknown_assets);
  EXPECT_FALSE(other->refuses_unknown_writers);
  EXPECT_FALSE(load_configuration(place.write("sealwatch.yaml", "unknown_assets: maybe\n"), {}));
}

INSTANTIATE_TEST_SUITE_P(All, BadConfiguration, ::testing::ValuesIn(kBadCases),
                         [](const auto& bad) { return std::string(bad.param.name); });

TEST(ConfigurationTest, ABrokenFileIsNamedWithItsLine) {
  const YamlPlace place;
  const auto found = faults(place, place.write("sealwatch.yaml", "domain: 1\nlogging: {level: info\n"));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0], HasSubstr("sealwatch.yaml: line 3: is not YAML: "));
}

TEST(ConfigurationTest, WhatTheYamlLibraryPassesOverIsNamed) {
  const YamlPlace place;
  EXPECT_THAT(faults(place, place.write("sealwatch.yaml", "domain: 1\nlogging:\n  level: \"info\n  directory: x\n")),
              ElementsAre("sealwatch.yaml: line 3: 'info directory: x ': is not YAML: the quoted text has no closing "
                          "quote"));
  EXPECT_THAT(faults(place, place.write("sealwatch.yaml", "domain: 1\n---\ndomain: 2\n")),
              ElementsAre("sealwatch.yaml: line 2: a second YAML document stands here; take out the line ---"));
  EXPECT_THAT(faults(place, place.write("sealwatch.yaml", "---\ndomain: 1\n...\n")), ElementsAre());
}

TEST(ConfigurationTest, AMissingFileIsNamed) {
  const YamlPlace place;
  EXPECT_THAT(faults(place, place.directory()),
              ElementsAre(::testing::AllOf(HasSubstr("sealwatch.yaml: does not exist"),
                                           HasSubstr("--config or SEALWATCH_CONFIG"), HasSubstr("/etc/sealwatch"))));
  // A relative path is told in full: where the program was started is the reader's first question.
  const auto relative = load_configuration("no/such/folder");
  ASSERT_FALSE(relative);
  EXPECT_EQ(relative.error().front().file, (std::filesystem::current_path() / "no/such/folder").string());
  const auto empty = load_configuration("");
  ASSERT_FALSE(empty);
  EXPECT_THAT(empty.error().front().rule, HasSubstr("does not exist: no configuration"));
}

TEST(ConfigurationTest, AllFaultsOfAllFilesAreNamedAtOnce) {
  const YamlPlace place;
  const std::string file = place.write("sealwatch.yaml", "domain: -1\nsites: [{site: north_field}]\nloging: {}\n");
  place.write("assets/1.yaml", "asset_id: A\nsite: north_feild\nmodel: eha\n");
  place.write("assets/2.yaml", "asset_id: B\nparameters: {f_C: -1, R_CI: 1}\n");
  EXPECT_THAT(
      faults(place, file),
      ElementsAre("sealwatch.yaml: line 1, key domain: '-1': must be a whole number from 0 to 232",
                  "sealwatch.yaml: line 3, key loging: 'loging': is not a known key; did you mean 'logging'?",
                  "assets/1.yaml: line 2, key site: 'north_feild': is not one of the configuration's sites; did you "
                  "mean 'north_field'?",
                  "assets/2.yaml: line 2, key parameters.f_C: '-1': must be a number above 0",
                  "assets/2.yaml: line 2, key parameters.R_CI: 'R_CI': is not a known key; did you mean 'R_CL'?"));
}

/// They ran before, and an upgrade refuses nothing that did: `config check` warns.
TEST(ConfigurationTest, TwoAssetsThatAreAlikeInTheIdsOfTheirTestsAreNoFault) {
  const YamlPlace place;
  const std::string file = place.write("sealwatch.yaml", "");
  place.write("assets/1.yaml", "asset_id: Ventil-\u00C4\n");
  place.write("assets/2.yaml", "asset_id: Ventil-\u00D6\n");
  const auto configuration = load_configuration(file);
  ASSERT_TRUE(configuration.has_value());
  EXPECT_EQ(configuration->assets.size(), 2U);
}

TEST(ConfigurationTest, OfEachAssetHasThatAssetAloneAndAllElse) {
  const YamlPlace place;
  const std::string file = place.write("sealwatch.yaml", "domain: 7\n");
  for (const char* asset : {"A", "B"})
    place.write(std::string("assets/") + asset + ".yaml", std::string("asset_id: ") + asset + "\n");
  const auto of_asset = configurations_of_assets(load_configuration(file).value());
  for (const char* asset : {"B", "A"}) {
    const Configuration one = of_asset(asset);
    ASSERT_EQ(one.assets.size(), 1U);
    EXPECT_EQ(one.assets[0].asset_id, asset);
    EXPECT_EQ(one.domain, 7);
  }
  EXPECT_TRUE(of_asset("C").assets.empty());
}

TEST(ConfigurationTest, OneIdForTwoAssetsIsNamedWithBothFiles) {
  const YamlPlace place;
  const std::string file = place.write("sealwatch.yaml", "");
  place.write("assets/1.yaml", "asset_id: A\n");
  place.write("assets/2.yaml", "asset_id: A\n");
  EXPECT_THAT(
      faults(place, file),
      ElementsAre("assets/2.yaml: key asset_id: 'A': is the id of another asset already, in assets/1.yaml; give "
                  "each asset an id of its own"));
}

TEST(ConfigurationTest, AnEmptyFileIsAllDefaults) {
  const YamlPlace place;
  const auto configuration = load_configuration(place.write("sealwatch.yaml", ""));
  ASSERT_TRUE(configuration.has_value());
  EXPECT_EQ(configuration->domain, 0);
  EXPECT_EQ(configuration->services.size(), 6U);
  EXPECT_EQ(configuration->services.at("state_detection").journal, "sqlite3://state/state_detection.db");
  EXPECT_TRUE(configuration->assets.empty());
}

TEST(ConfigurationTest, EveryKeyIsRead) {
  const YamlPlace place;
  place.write("mine/a.yaml", "asset_id: A\nsite: s\n");
  const auto configuration = load_configuration(place.write("sealwatch.yaml", R"(
domain: 7
state_directory: /var/s
cyclonedds_uri: <x/>
logging: {level: debug, directory: logs, rotate_at_MB: 0.5, rotated_files: 3}
services:
  data_acquisition: {enabled: false, journal: "sqlite3://x.db", recordings_directory: in, deadline_s: 7.5}
topics: {advisory: {keep_all: false, transient_local: false, lifespan_s: 3}}
sites:
  - site: s
    booking_lead_time_months: 9
    campaigns: [{label: later, start: 2019-01-02}, {label: sooner, start: 2018-01-02}]
assets: [mine/a.yaml]
)"));
  ASSERT_TRUE(configuration.has_value()) << combine(configuration.error()).describe();
  EXPECT_EQ(configuration->domain, 7);
  EXPECT_EQ(configuration->cyclonedds_uri, "<x/>");
  EXPECT_EQ(configuration->logging.level, "debug");
  EXPECT_EQ(configuration->logging.directory, "/var/s/logs");
  EXPECT_EQ(configuration->logging.rotate_at_MB, 0.5);
  EXPECT_EQ(configuration->logging.rotated_files, 3);
  EXPECT_EQ(configuration->services.at("data_acquisition").deadline_s, 7.5);
  EXPECT_EQ(configuration->services.at("state_detection").deadline_s, 120.0);
  EXPECT_FALSE(configuration->services.at("data_acquisition").enabled);
  EXPECT_EQ(configuration->services.at("data_acquisition").journal, "sqlite3://x.db");
  EXPECT_EQ(configuration->services.at("data_acquisition").recordings_directory, "/var/s/in");
  EXPECT_EQ(configuration->services.at("state_detection").journal, "sqlite3:///var/s/state_detection.db");
  EXPECT_FALSE(configuration->topics.at("advisory").keep_all);
  EXPECT_FALSE(configuration->topics.at("advisory").transient_local);
  EXPECT_EQ(configuration->topics.at("advisory").lifespan_s, 3.0);
  const SiteConfig* site = configuration->find_site("s");
  ASSERT_NE(site, nullptr);
  EXPECT_EQ(site->booking_lead_time_months, 9.0);
  ASSERT_EQ(site->campaigns.size(), 2U);
  EXPECT_EQ(site->campaigns[0].label, "sooner") << "sorted";
  EXPECT_EQ(site->campaigns[1].label, "later");
  EXPECT_NE(configuration->find_asset("A"), nullptr);
}

TEST(ConfigurationTest, ForecastersAndAdviceAreThoseOfTheirServices) {
  const YamlPlace place;
  const auto configuration = load_configuration(place.write("sealwatch.yaml", R"(
services:
  prognostic_assessment:
    forecasters:
      - {method: ols, window_months: 24}
      - {method: average, members: [{method: ols_drift}, {method: ols_log_time, window_months: 48}]}
  advisory_generation:
    advice: {largest_failure_probability: 0.05, easing_tests: 6}
)"));
  ASSERT_TRUE(configuration.has_value()) << combine(configuration.error()).describe();
  ASSERT_EQ(configuration->forecasters.size(), 2U);
  EXPECT_EQ(configuration->forecasters[0].method, "ols");
  EXPECT_EQ(configuration->forecasters[0].window_months, 24);
  ASSERT_EQ(configuration->forecasters[1].members.size(), 2U);
  EXPECT_EQ(configuration->forecasters[1].members[1].window_months, 48);
  EXPECT_EQ(configuration->advice.largest_failure_probability, 0.05);
  EXPECT_EQ(configuration->advice.easing_tests, 6U);
  EXPECT_EQ(configuration->advice.confirming_tests, AdviceOptions{}.confirming_tests);
}

TEST(ConfigurationTest, TheFleetIsReadWholeOrRefused) {
  const YamlPlace place;
  const std::string begin =
      "services:\n  prognostic_assessment:\n    fleet: {initial_rate: 0.05, initial_rate_std: 0.008, "
      "steepening: 0.0012,\n            steepening_std: ";
  const std::string end = ", rate_steepening_correlation: 0.3, irregularity_std: 0.03}\n";
  const auto good = load_configuration(place.write("good.yaml", begin + "0.0002" + end));
  ASSERT_TRUE(good.has_value()) << combine(good.error()).describe();
  ASSERT_TRUE(good->fleet.has_value());
  EXPECT_EQ(good->fleet->steepening_std, 0.0002);
  EXPECT_FALSE(load_configuration(place.write("none.yaml", "services: {}\n"))->fleet.has_value());
  const auto negative = load_configuration(place.write("bad.yaml", begin + "-1" + end));
  ASSERT_FALSE(negative.has_value());
  EXPECT_NE(combine(negative.error()).describe().find("fleet.steepening_std"), std::string::npos);
  const auto part = load_configuration(
      place.write("part.yaml", "services: {prognostic_assessment: {fleet: {initial_rate: 0.05}}}\n"));
  ASSERT_FALSE(part.has_value());
  EXPECT_NE(combine(part.error()).describe().find("irregularity_std: must be given"), std::string::npos);
}

TEST(ConfigurationTest, ASiteThatIsThereTwiceIsSuggestedOnce) {
  const YamlPlace place;
  place.write("assets/a.yaml", "asset_id: A\nsite: quite_another\n");
  const auto found = faults(place, place.write("sealwatch.yaml", "sites:\n  - site: north\n  - site: north\n"));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_THAT(found[1], ::testing::EndsWith("known are: north"));
}

TEST(ConfigurationTest, WhatHasHappenedIsNotInTheFuture) {
  const YamlPlace place;
  const std::string file =
      place.write("sealwatch.yaml", "sites:\n  - site: a\n    safety:\n      last_full_stroke: 2017-05-01\n");
  const auto at = [&](const char* day) { return load_configuration(file, {.now = *parse_utc(day)}); };
  EXPECT_TRUE(at("2017-05-02").has_value());
  EXPECT_TRUE(load_configuration(file).has_value()) << "a service whose clock is wrong starts nevertheless";
  const auto before = at("2017-04-30");
  ASSERT_FALSE(before.has_value());
  EXPECT_EQ(place.bare(before.error().at(0).describe()),
            "sealwatch.yaml: line 4, key sites[0].safety.last_full_stroke: '2017-05-01': is in the future; write the "
            "day of the last one");
}

TEST(ConfigurationTest, AKeyHasAPlaceWhereItStandsInTheFile) {
  const YamlPlace place;
  (void)place.write("sealwatch.yaml", "domain: 1\nservices:\n  state_detection:\n    journal: \"\"\n");
  EXPECT_EQ(place_in_configuration(place.directory(), "services.state_detection.journal"),
            "line 4, key services.state_detection.journal");
  EXPECT_EQ(place_in_configuration(place.directory(), "state_directory"), "key state_directory");
  EXPECT_EQ(place_in_configuration(place.directory(), "services.state_detection.enabled"),
            "key services.state_detection.enabled");
}

TEST(ConfigurationTest, TheCommandLineWinsOverTheFile) {
  const YamlPlace place;
  const auto configuration = load_configuration(place.write("sealwatch.yaml", "domain: 7\nlogging: {directory: log}\n"),
                                                {.state_directory = "/other", .domain = 9});
  ASSERT_TRUE(configuration.has_value());
  EXPECT_EQ(configuration->domain, 9);
  EXPECT_EQ(configuration->services.at("state_detection").journal, "sqlite3:///other/state_detection.db");
  EXPECT_EQ(configuration->logging.directory, "/other/log");
}

TEST(ConfigurationTest, TheOneThatComesWithSealwatchIsValid) {
  const auto configuration = load_configuration(SEALWATCH_SOURCE_DIR "/config");
  ASSERT_TRUE(configuration.has_value()) << combine(configuration.error()).describe();
  const auto same_as_default = [](std::string_view name, auto written, auto standard) {
    EXPECT_EQ(written, standard) << name << ": the file says that it shows the defaults";
  };
  AdviceOptions::visit_pair(same_as_default, configuration->advice, AdviceOptions{});
  const AssetConfig* asset = configuration->find_asset("XT03-MV2");
  ASSERT_NE(asset, nullptr);
  EXPECT_TRUE(asset->condition.has_value());
  const SiteConfig* site = configuration->find_site(asset->site);
  ASSERT_NE(site, nullptr);
  EXPECT_FALSE(site->campaigns.empty());
}

}  // namespace
}  // namespace sealwatch::testing
