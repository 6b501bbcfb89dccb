// The manual page sealwatch(1), made from the program's own options and help texts, so that it cannot fall behind them.
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace sealwatch::cli {

namespace detail {

/// Text for roff: backslashes and dashes escaped, no line begins with a dot.
inline std::string roff(const std::string& text) {
  std::string result;
  for (const char letter : text) {
    if (letter == '\\' || letter == '-') result += '\\';
    if ((letter == '.' || letter == '\'') && (result.empty() || result.back() == '\n')) result += "\\&";
    result += letter;
  }
  return result;
}

/// Its own, and those in groups, which have no name.
inline void describe_options(const CLI::App& app, std::string& page) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_name() == "--help") continue;
    page += ".TP\n\\fB" + roff(option->get_name(false, true)) + "\\fR\n" + roff(option->get_description());
    if (!option->get_default_str().empty()) page += " (default: " + roff(option->get_default_str()) + ")";
    page += "\n";
  }
  for (const CLI::App* part : app.get_subcommands([](const CLI::App*) { return true; }))
    if (part->get_name().empty()) describe_options(*part, page);
}

inline void describe(const CLI::App& app, const std::string& path, std::string& page) {
  page += ".SS \"" + path + "\"\n" + roff(app.get_description()) + "\n";
  describe_options(app, page);
  if (!app.get_footer().empty()) page += ".PP\n.nf\n" + roff(app.get_footer()) + "\n.fi\n";
  for (const CLI::App* subcommand : app.get_subcommands([](const CLI::App*) { return true; }))
    if (!subcommand->get_name().empty()) describe(*subcommand, path + " " + subcommand->get_name(), page);
}

}  // namespace detail

/// The page that `sealwatch manual` prints: read it with `man -l`.
inline std::string manual_page(const CLI::App& app, const std::string& version) {
  std::string page = ".TH SEALWATCH 1 \"\" \"sealwatch " + version + "\" \"User Commands\"\n.SH NAME\nsealwatch \\- " +
                     detail::roff(app.get_description()) +
                     "\n.SH SYNOPSIS\n.B sealwatch\n\\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n.SH COMMANDS\n";
  for (const CLI::App* subcommand : app.get_subcommands([](const CLI::App*) { return true; }))
    detail::describe(*subcommand, "sealwatch " + subcommand->get_name(), page);
  return page +
         ".SH EXIT STATUS\n0 ok; 1 the command ran and the answer is \"no\"; 2 bad usage or input; 3 internal "
         "failure.\n"
         ".SH ENVIRONMENT\n.TP\n.B SEALWATCH_CONFIG\nconfiguration file or directory where \\-\\-config is not given\n"
         ".TP\n.B CYCLONEDDS_URI\nsettings of Cyclone DDS: network interfaces, discovery, security\n"
         ".SH FILES\n.TP\n.I /etc/sealwatch\nconfiguration of an installed system\n.TP\n.I "
         "/var/lib/sealwatch\njournals of an installed system\n";
}

}  // namespace sealwatch::cli
