// Arguments of the commands by which operators act.
#include <memory>

#include "services/cli/arguments.hpp"
#include "services/cli/command_line.hpp"
#include "services/cli/commands.hpp"

namespace sealwatch::cli {
namespace {

void add_acknowledge(CommandLine& line) {
  const auto options = std::make_shared<AcknowledgeOptions>();
  CLI::App* acknowledge = line.command("acknowledge", "acknowledge an advisory or an alarm",
                                       "sealwatch acknowledge XT03-MV2 ADVISORY_ID --by 'J. Silva'",
                                       [options] { return run_acknowledge(*options); });
  CommandLine::add_config(acknowledge, options->config);
  acknowledge->add_option("asset", options->asset_id, "asset id, or - for an alarm that concerns no asset")->required();
  acknowledge->add_option("advisory", options->advisory_id, "advisory id, or an alarm's id as `status --json` shows it")
      ->required();
  acknowledge->add_option("--by", options->by, "your name")->required();
  acknowledge->add_option("--remark", options->remark, "free text");
}

void add_replaced(CommandLine& line) {
  const auto options = std::make_shared<ReplacedOptions>();
  CLI::App* replaced = line.command("replaced", "report a replaced actuator or seal: its histories restart",
                                    "sealwatch replaced XT03-MV2 --at 2018-05-02 --by 'J. Silva'",
                                    [options] { return run_replaced(*options); });
  CommandLine::add_config(replaced, options->config);
  replaced->add_option("asset", options->asset_id, "asset id")->required();
  replaced->add_option("--at", options->at, "UTC time of the replacement")->required();
  replaced->add_option("--what", options->what, "actuator or seal")
      ->check(CLI::IsMember({"actuator", "seal"}))
      ->capture_default_str();
  replaced->add_option("--by", options->by, "your name")->required();
  replaced->add_option("--remark", options->remark, "free text");
}

void add_shelving(CommandLine& line) {
  const auto options = std::make_shared<ShelveOptions>();
  CLI::App* shelve = line.command("shelve", "hide an alarm or advisory until a date",
                                  "sealwatch shelve XT03-MV2 sensor_lost/pressure_a --until 2031-06-01 --by 'J. Silva' "
                                  "--reason 'sensor ordered'",
                                  [options] { return run_shelve(*options); });
  shelve->add_option("--until", options->until, "UTC time, at most a year ahead")->required();
  CLI::App* unshelve = line.command("unshelve", "show a shelved alarm again",
                                    "sealwatch unshelve XT03-MV2 sensor_lost/pressure_a --by 'J. Silva'",
                                    [options] { return run_shelve(*options); });
  for (CLI::App* one : {shelve, unshelve}) {
    CommandLine::add_config(one, options->config);
    one->add_option("asset", options->asset_id, "asset id, or - for an alarm that concerns no asset")->required();
    one->add_option("alarm", options->alarm_id, "the alarm's id as `status --json` shows it")->required();
    one->add_option("--by", options->by, "your name")->required();
  }
  shelve->add_option("--reason", options->reason, "the reason")->required();
  unshelve->add_option("--reason", options->reason, "the reason");
}

void add_out_of_service(CommandLine& line) {
  const auto options = std::make_shared<OutOfServiceOptions>();
  CLI::App* out = line.command("out-of-service", "hide an asset's alarms during work on it",
                               "sealwatch out-of-service XT03-MV2 --by 'J. Silva' --reason 'valve is being replaced'",
                               [options] { return run_out_of_service(*options); });
  out->add_option("--reason", options->reason, "the reason")->required();
  CLI::App* in = line.command("in-service", "show an asset's alarms again",
                              "sealwatch in-service XT03-MV2 --by 'J. Silva'", [options] {
                                options->back = true;
                                return run_out_of_service(*options);
                              });
  in->add_option("--reason", options->reason, "free text");
  for (CLI::App* one : {out, in}) {
    CommandLine::add_config(one, options->config);
    one->add_option("asset", options->asset_id, "asset id")->required();
    one->add_option("--by", options->by, "your name")->required();
  }
}

void add_retract(CommandLine& line) {
  const auto options = std::make_shared<RetractOptions>();
  CLI::App* retract = line.command("retract", "exclude a test, or all since a date (reversible)",
                                   "sealwatch retract XT03-MV2 --test PST_ID --by 'J. Silva' --reason 'wrong valve'",
                                   [options] { return run_retract(*options); });
  CommandLine::add_config(retract, options->config);
  retract->add_option("asset", options->asset_id, "asset id")->required();
  CLI::Option_group* what = retract->add_option_group("what");
  what->add_option("--test", options->pst_id, "the test's PST id, as shown by `show` and `status`");
  what->add_option("--since", options->since, "UTC time: all tests known now that were made at or after it");
  what->add_option("--withdraw", options->withdraw,
                   "id of a retraction or replacement: the tests that it set aside count again");
  what->require_option(1);
  retract->add_option("--by", options->by, "your name")->required();
  retract->add_option("--reason", options->reason, "the reason")->required();
}

void add_confirm(CommandLine& line) {
  const auto options = std::make_shared<ConfirmOptions>();
  CLI::App* confirm =
      line.command("confirm", "confirm another person's act where two people are required",
                   "sealwatch confirm XT03-MV2 ACT_ID --by 'M. Okoye'", [options] { return run_confirm(*options); });
  CommandLine::add_config(confirm, options->config);
  confirm->add_option("asset", options->asset_id, "asset id")->required();
  confirm
      ->add_option("act", options->act_id,
                   "id of the waiting replacement, retraction or accepted model, as `status` shows it")
      ->required();
  confirm->add_flag("--reject", options->reject, "reject it instead; the person who reported it may do so, too");
  confirm->add_option("--by", options->by, "your name; not that of the person who reported it")->required();
  confirm->add_option("--remark", options->remark, "free text");
}

void add_accept(CommandLine& line) {
  const auto options = std::make_shared<AcceptOptions>();
  CLI::App* accept = line.command("accept", "let the services use an explained model, or --revoke it",
                                  "sealwatch accept --asset-id XT03-MV2 --discrepancy ID --by 'J. Silva'",
                                  [options] { return run_accept(*options); });
  CommandLine::add_config(accept, options->config);
  accept->add_option("--asset-id", options->asset_id, "asset id")->required();
  accept->add_option("--discrepancy", options->discrepancy_id, "id of the model_discrepancy, as `status` shows it")
      ->required();
  accept->add_flag("--revoke", options->revoke, "return to the model of the asset file");
  accept->add_option("--by", options->by, "your name")->required();
  accept->add_option("--remark", options->remark, "free text");
}

}  // namespace

void add_operation(CommandLine& line) {
  line.begin_group("Operate");
  for (const auto add :
       {&add_acknowledge, &add_replaced, &add_shelving, &add_out_of_service, &add_retract, &add_confirm, &add_accept})
    add(line);
}

}  // namespace sealwatch::cli
