// The command line of `sealwatch`: what commands have in common, and which was chosen. Each group of --help declares its
// commands in a file of its own: commands_GROUP.cpp.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace sealwatch::cli {

class CommandLine {
 public:
  CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;
  /// Parses the arguments and runs what they choose; the exit status.
  int run(int argc, char** argv);

  /// Commands from here on stand under this heading of --help.
  void begin_group(std::string heading) { group_ = std::move(heading); }
  CLI::App* command(const std::string& name, const std::string& meaning, const std::string& example,
                    std::function<int()> run);
  /// A command that only holds others.
  CLI::App* holder(const std::string& name, const std::string& meaning, const std::string& example);
  CLI::App* nested(CLI::App& holder, const std::string& name, const std::string& meaning, const std::string& example,
                   std::function<int()> run);
  void choose(std::function<int()> run) { chosen_ = std::move(run); }

  static void add_config(CLI::App* subcommand, std::string& config);
  /// Says in the command's help what its exit status 1 means.
  static void one_means(CLI::App* subcommand, const std::string& meaning);
  /// What every command that reads recordings takes.
  static void add_map(CLI::App* subcommand, std::string& map_file);

  [[nodiscard]] const CLI::App& app() const { return app_; }
  /// For who gives no command: what the program is, and the first commands with an example each.
  [[nodiscard]] std::string overview() const;
  /// Those given, without the program's name; ends with nullptr.
  [[nodiscard]] const std::vector<char*>& arguments() const { return arguments_; }

 private:
  [[nodiscard]] std::vector<std::string> commands() const;
  [[nodiscard]] int unknown(const std::string& name) const;
  /// Whether an option that was given is none of its command's; says so.
  [[nodiscard]] bool tells_unknown_option() const;
  /// The command that was given, with that of a group such as `plant check`.
  [[nodiscard]] const CLI::App* given() const;
  /// "sealwatch fit: --asset is required; sealwatch fit --help has an example".
  [[nodiscard]] std::string failure(const CLI::Error& error) const;

  CLI::App app_;
  std::string group_;
  int help(int argc, char** argv);

  std::vector<char*> arguments_;
  std::function<int()> chosen_;
};

void add_analysis(CommandLine& line);
void add_services(CommandLine& line);
void add_operation(CommandLine& line);
void add_maintenance(CommandLine& line);

}  // namespace sealwatch::cli
