// Arguments of the commands that maintain an installation.
#include <iostream>
#include <memory>
#include <string>

#include "services/cli/arguments.hpp"
#include "services/cli/command_line.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/completion.hpp"
#include "services/cli/manual.hpp"
#include "services/cli/session.hpp"

namespace sealwatch::cli {
namespace {

void add_quarantine(CommandLine& line) {
  const auto options = std::make_shared<QuarantineOptions>();
  CLI::App* quarantine = line.holder("quarantine", "list or retry tests on which a service failed twice",
                                     "sealwatch quarantine list --state STATE\n  sealwatch quarantine retry "
                                     "test_window/XT03-MV2-20180324T033939Z-ca97c069 --by 'J. Silva'");
  CLI::App* list = line.nested(*quarantine, "list", "list what is in quarantine, since when and why",
                               "sealwatch quarantine list --state /var/lib/sealwatch",
                               [options] { return run_quarantine_list(*options); });
  CommandLine::one_means(list, "something is in quarantine");
  list->add_flag("--all", options->all, "also show past retries and who requested them");
  list->add_flag("--json", options->json, "machine-readable result (schema sealwatch.quarantine/1)");
  CLI::App* retry = line.nested(
      *quarantine, "retry", "process a message and its test again",
      "sealwatch quarantine retry sample_block/XT03-MV2-20180324T033939Z-ca97c069/30 --by 'J. Silva'\nA running "
      "service "
      "retries it within seconds, a stopped one when it starts. If it fails twice again, it returns to quarantine.",
      [options] { return run_quarantine_retry(*options); });
  retry->add_option("id", options->message_id, "message id, or PST id, as `quarantine list` shows it")->required();
  retry->add_option("--by", options->by, "your name")->required();
  for (CLI::App* one : {list, retry}) {
    CommandLine::add_config(one, options->config);
    one->add_option("--state", options->state_directory,
                    "state directory of the services (running or not), instead of the configuration's");
  }
}

void add_audit(CommandLine& line) {
  const auto options = std::make_shared<AuditOptions>();
  CLI::App* audit =
      line.command("audit", "show the trail of operator actions and check its integrity",
                   "sealwatch audit --state STATE\n  sealwatch audit --asset XT03-MV2 --json\n  sealwatch "
                   "audit --contains HASH",
                   [options] { return run_audit(*options); });
  CommandLine::add_config(audit, options->config);
  audit->add_option("--state", options->state_directory,
                    "state directory of the services (running or not), instead of the configuration's");
  audit->add_option("--asset", options->asset_id, "show the actions on one asset; the whole trail is checked anyway");
  audit->add_option("--contains", options->contains,
                    "check that a hash noted earlier is still in the trail (if not, the trail was truncated)");
  audit->add_flag("--json", options->json, "machine-readable result (schema sealwatch.audit/1)");
}

void add_backup(CommandLine& line) {
  const auto options = std::make_shared<BackupOptions>();
  CLI::App* backup = line.command("backup", "copy the services' journals while they run (without configuration)",
                                  "sealwatch backup --state STATE --to /backup/2031-04-12",
                                  [options] { return run_backup(*options); });
  backup->add_option("--to", options->directory, "directory for the copies: SERVICE.db")->required();
  CLI::App* restore = line.command("restore", "replace the journals of stopped services by a backup",
                                   "sealwatch restore --state STATE --from /backup/2031-04-12",
                                   [options] { return run_restore(*options); });
  restore
      ->add_option(
          "--from", options->directory,
          "directory with the copies: SERVICE.db of each to restore; the present journals are kept beside them")
      ->required();
  for (CLI::App* one : {backup, restore}) {
    CommandLine::add_config(one, options->config);
    one->add_option("--state", options->state_directory, "state directory of the services");
  }
}

void add_config_commands(CommandLine& line) {
  const auto options = std::make_shared<ConfigCheckOptions>();
  CLI::App* config = line.holder("config", "check the configuration", "sealwatch config check --config /etc/sealwatch");
  CLI::App* check =
      line.nested(*config, "check", "list every fault in the configuration, with file and line",
                  "sealwatch config check --config /etc/sealwatch", [options] { return run_config_check(*options); });
  CommandLine::add_config(check, options->config);
  check->add_flag("--json", options->json, "machine-readable result");
}

void add_completion(CommandLine& line) {
  const auto options = std::make_shared<CompletionOptions>();
  CLI::App* completion = line.command("completion", "print a completion script for bash or zsh",
                                      "source <(sealwatch completion bash)", [options, &line] {
                                        std::cout << completion_script(line.app(), options->shell);
                                        return kOk;
                                      });
  completion->add_option("shell", options->shell, "bash or zsh")
      ->check(CLI::IsMember({"bash", "zsh"}))
      ->capture_default_str();
}

void add_manual(CommandLine& line) {
  line.command("manual", "print this program's manual page", "sealwatch manual | man -l -", [&line] {
    std::cout << manual_page(line.app(), SEALWATCH_VERSION);
    return kOk;
  });
}

}  // namespace

void add_maintenance(CommandLine& line) {
  line.begin_group("Maintain");
  for (const auto add : {&add_quarantine, &add_audit, &add_backup, &add_config_commands, &add_completion, &add_manual})
    add(line);
}

}  // namespace sealwatch::cli
