// Shell completion made from the program's own options, so that it cannot fall behind them.
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace sealwatch::cli {

namespace detail {

/// "case" arm of one (sub)command: its subcommands and options.
inline void add_words(const CLI::App& app, const std::string& path, std::string& arms) {
  std::string words;
  for (const CLI::App* subcommand : app.get_subcommands([](const CLI::App*) { return true; }))
    words += subcommand->get_name() + " ";
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) words += "--" + name + " ";
  arms += "    \"" + path + "\") words=\"" + words + "\" ;;\n";
  for (const CLI::App* subcommand : app.get_subcommands([](const CLI::App*) { return true; }))
    add_words(*subcommand, path + " " + subcommand->get_name(), arms);
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
