// Shell completion made from the program's own options, so that it cannot fall behind them.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace sealwatch::cli {

namespace detail {

/// Its subcommands, and the groups of options, which have no name.
inline std::vector<const CLI::App*> parts_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

inline std::string words_of(const CLI::App& app) {
  std::string words;
  for (const CLI::App* part : parts_of(app))
    words += part->get_name().empty() ? words_of(*part) : part->get_name() + " ";
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames())
      if (name != "help" || !app.get_name().empty()) words += "--" + name + " ";
  return words;
}

/// "case" arm of one (sub)command: its subcommands and options.
inline void add_words(const CLI::App& app, const std::string& path, std::string& arms) {
  arms += "    \"" + path + "\") words=\"" + words_of(app) + "\" ;;\n";
  for (const CLI::App* part : parts_of(app))
    if (!part->get_name().empty()) add_words(*part, path + " " + part->get_name(), arms);
}

}  // namespace detail

/// The script that `sealwatch completion SHELL` prints.
inline std::string completion_script(const CLI::App& app, const std::string& shell) {
  std::string arms;
  detail::add_words(app, "sealwatch", arms);
  std::string script = "# sealwatch completion; use: source <(sealwatch completion " + shell + ")\n";
  if (shell == "zsh") script += "autoload -U +X bashcompinit && bashcompinit\n";
  return script +
         "_sealwatch_words() {\n"
         "  case \"$1\" in\n" +
         arms +
         "    *) return 1 ;;\n"
         "  esac\n"
         "}\n"
         "_sealwatch() {\n"
         "  local path=sealwatch words word\n"
         "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
         "    _sealwatch_words \"$path $word\" && path=\"$path $word\"\n"
         "  done\n"
         "  _sealwatch_words \"$path\"\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\"))\n"
         "}\n"
         "complete -o default -F _sealwatch sealwatch\n";
}

}  // namespace sealwatch::cli
