#include "services/cli/command_line.hpp"

#include <algorithm>
#include <array>
#include <iostream>

#include "sealwatch/core/text.hpp"
#include "services/cli/arguments.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/common/core/build_version.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

std::string footer_of(const std::string& example) { return "Example:\n  " + example + "\n" + kExitStatus; }

/// What a newcomer does first, in this order, from the root of the checkout: each works on what those before it have
/// made, but for the last two, which need recordings of a machine.
struct FirstStep {
  const char* command;
  const char* example;
};
constexpr std::array kFirstSteps = {
    FirstStep{"simulate",
              "sealwatch simulate --asset config/assets/xt03-mv2.yaml --ageing --months 48 --out first/life"},
    FirstStep{"fit", "sealwatch fit --asset config/assets/xt03-mv2.yaml first/life/2009-05*.csv"},
    FirstStep{"replay", "sealwatch replay --with-services --state first/state first/life/*.csv"},
    FirstStep{"forecast", "sealwatch forecast --state first/state --page first/forecast.html"},
    FirstStep{"asset", "sealwatch asset new --from LOG.csv --out A.yaml"},
    FirstStep{"explain", "sealwatch explain --asset A.yaml --fit fit_*.csv --holdout holdout_*.csv --out report"}};

std::string first_steps() {
  std::string text = "First steps (docs/tutorial.md):\n";
  for (const FirstStep& step : kFirstSteps) text.append("  ").append(step.example).append("\n");
  return text + "  sealwatch COMMAND --help\n";
}

}  // namespace

CommandLine::CommandLine()
    : app_("sealwatch: condition monitoring of electro-hydrostatic subsea valve actuators", "sealwatch"),
      chosen_([] { return kBadInput; }) {
  app_.set_version_flag("--version", version_line());
  app_.require_subcommand(1);
  app_.footer(first_steps() + kExitStatus);
  for (const auto add : {&add_analysis, &add_services, &add_operation, &add_maintenance}) add(*this);
}

std::string CommandLine::overview() const {
  std::string text =
      app_.get_description() +
      "\n\nFrom recorded partial stroke tests it estimates the leakage past the piston seal, forecasts the "
      "remaining\nuseful life and advises when to act. Where recordings differ from a simulation, it names "
      "the missing physics.\n\nBegin with:\n";
  std::size_t width = 0;
  for (const FirstStep& step : kFirstSteps) width = std::max(width, text::letters(step.command));
  for (const FirstStep& step : kFirstSteps)
    text.append("  ")
        .append(text::padded(step.command, width))
        .append("  ")
        .append(app_.get_subcommand(step.command)->get_description())
        .append("\n")
        .append(width + 4, ' ')
        .append(step.example)
        .append("\n");
  return text +
         "\nsealwatch --help lists all commands, sealwatch COMMAND --help explains one; docs/tutorial.md leads on.\n";
}

int CommandLine::run(int argc, char** argv) {
  if (argc <= 1) {
    std::cerr << overview();
    return kBadInput;
  }
  if (std::string_view(argv[1]) == "help") return help(argc, argv);
  const std::vector<std::string> known = commands();
  if (argv[1][0] != '-' && std::ranges::find(known, argv[1]) == known.end()) return unknown(argv[1]);
  arguments_.assign(argv + 1, argv + argc + 1);
  try {
    app_.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // A misspelt option comes before what is missing because of it.
    if (error.get_exit_code() != 0 && tells_unknown_option()) return kBadInput;
    if (error.get_exit_code() == 0) return app_.exit(error), kOk;
    std::cerr << failure(error);
    return kBadInput;
  }
  return chosen_();
}

/// "sealwatch help fit" is "sealwatch fit --help".
int CommandLine::help(int argc, char** argv) {
  std::string option = "--help";
  std::vector<char*> words{argv[0]};
  words.insert(words.end(), argv + 2, argv + argc);
  words.push_back(option.data());
  words.push_back(nullptr);
  return run(argc, words.data());
}

CLI::App* CommandLine::command(const std::string& name, const std::string& meaning, const std::string& example,
                               std::function<int()> run) {
  CLI::App* subcommand = nested(app_, name, meaning, example, std::move(run));
  subcommand->group(group_);
  return subcommand;
}

CLI::App* CommandLine::holder(const std::string& name, const std::string& meaning, const std::string& example) {
  CLI::App* subcommand = app_.add_subcommand(name, meaning);
  subcommand->require_subcommand(1);
  subcommand->footer(footer_of(example));
  subcommand->group(group_);
  return subcommand;
}

CLI::App* CommandLine::nested(CLI::App& holder, const std::string& name, const std::string& meaning,
                              const std::string& example, std::function<int()> run) {
  CLI::App* subcommand = holder.add_subcommand(name, meaning);
  subcommand->footer(footer_of(example));
  subcommand->callback([this, run = std::move(run)] { chosen_ = run; });
  return subcommand;
}

void CommandLine::add_config(CLI::App* subcommand, std::string& config) {
  config = default_config();
  subcommand->add_option("--config", config, "configuration file or directory ($SEALWATCH_CONFIG)")
      ->capture_default_str();
}

void CommandLine::one_means(CLI::App* subcommand, const std::string& meaning) {
  subcommand->footer(subcommand->get_footer() + " Here 1 means: " + meaning + ".");
}

void CommandLine::add_map(CLI::App* subcommand, std::string& map_file) {
  subcommand
      ->add_option(
          "--map", map_file,
          "YAML file with channels: (columns and units of your own log, docs/logs.md); replaces the asset file's")
      ->check(CLI::ExistingFile);
}

std::vector<std::string> CommandLine::commands() const {
  std::vector<std::string> names;
  for (const CLI::App* subcommand : app_.get_subcommands(nullptr)) names.push_back(subcommand->get_name());
  return names;
}

const CLI::App* CommandLine::given() const {
  const CLI::App* command = &app_;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  return command;
}

std::string CommandLine::failure(const CLI::Error& error) const {
  std::string name;
  for (const CLI::App* app = given(); app != nullptr; app = app->get_parent())
    name.insert(0, name.empty() ? app->get_name() : app->get_name() + " ");
  return name + ": " + error.what() + "; " + name + " --help has an example\n";
}

bool CommandLine::tells_unknown_option() const {
  const CLI::App* command = given();
  const std::vector<std::string> left = command->remaining();
  const auto option = std::ranges::find_if(left, [](const std::string& one) { return one.starts_with("--"); });
  if (option == left.end() || *option == "--") return false;
  std::vector<std::string> known;
  for (const CLI::Option* one : command->get_options())
    for (const std::string& name : one->get_lnames()) known.push_back("--" + name);
  const std::string given = option->substr(0, option->find('='));
  complain(Error{.file = {},
                 .place = {},
                 .value = given,
                 .rule = "is not an option of this command",
                 .advice = suggest(given, known)});
  return true;
}

int CommandLine::unknown(const std::string& name) const {
  complain(
      Error{.file = {}, .place = {}, .value = name, .rule = "is not a command", .advice = suggest(name, commands())});
  return kBadInput;
}

}  // namespace sealwatch::cli
