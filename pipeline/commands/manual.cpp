// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/manual.h"

#include <map>
#include <utility>

#include <fmt/format.h>

#include "pipeline/commands/help.h"

namespace salbench {
namespace {

constexpr const char* kAbout =
    R"(How well does a program predict which points of a shape people find important?
\fBsalbench\fR takes meshes, simulated range scans of them and point clouds through normals, descriptors (FPFH),
saliency models, histogram matching and metrics. Every intermediate is kept in a cache: a rerun computes what is missing and nothing else.
.PP
\fBsalbench\-report\fR turns a results folder into pages with figures and tables; \fBsalbench\-report \-\-help\fR names its
options. It needs the packages that are recommended beside salbench.
.PP
\fICONFIG\fR is a configuration file, or the name of an installed one, such as \fIshrec07\fR.
)";

constexpr const char* kFiles = R"(.SH FILES
.TP
.I share/salbench/configs/
Installed configurations, below the prefix of the program (on Debian \fI/usr\fR).
.TP
.I share/doc/salbench/data_dictionary.md
Every file, table and attribute that the program writes.
.TP
.I salbench\-cache/
The artefacts, unless \fB\-\-cache\fR or the configuration names another folder.
.TP
.I salbench\-out/NAME/
The results, NAME being that of the configuration, unless \fB\-\-out\fR or the configuration names another folder.
.SH SEE ALSO
.I share/doc/salbench/README.md
)";

constexpr const char* kCompletion = R"bash(# bash completion for salbench, made from its help texts
_salbench() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}}
  local options='--help --version' configs='' folder
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W "{} $options" -- "$word")
    return
  fi
  case ${{COMP_WORDS[1]}} in
{}
  esac
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
    return
  fi
  case $before in
    {}) return ;;  # its value: what is left empty here is completed as a file
  esac
  folder=$(dirname "$(command -v "${{COMP_WORDS[0]}}")")/../share/salbench/configs
  [[ ! -d $folder ]] || configs=$(cd "$folder" && printf '%s ' *.yaml)
  mapfile -t COMPREPLY < <(compgen -W "${{configs//.yaml/}}" -- "$word"; compgen -f -- "$word")
  compopt -o filenames 2> /dev/null
}}
complete -o bashdefault -o default -F _salbench salbench
)bash";

std::vector<Subcommand> described(std::span<const SubcommandRow> rows, Arguments& arguments) {
  std::vector<Subcommand> subcommands;
  for (const SubcommandRow row : rows) subcommands.push_back(row(arguments));
  return subcommands;
}

// As roff prints it: a hyphen that can be copied into a shell, and no line that is taken for a request.
std::string roff(const std::string& text) {
  std::string escaped = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (const char c : text) {
    if (c == '\\')
      escaped += "\\e";
    else
      escaped += c == '-' ? std::string("\\-") : std::string(1, c);
  }
  return escaped;
}

bool is_option(const Parameter& parameter) { return parameter.name.starts_with('-'); }

std::string placeholder(const Parameter& parameter) {
  if (std::holds_alternative<bool*>(parameter.target)) return "";
  return std::holds_alternative<int*>(parameter.target) ? "INT" : "TEXT";
}

// "CONFIG", "[CONFIG...]"
std::string positional(const Parameter& parameter) {
  const std::string name =
      parameter.name + (std::holds_alternative<std::vector<std::string>*>(parameter.target) ? "..." : "");
  return parameter.required ? name : "[" + name + "]";
}

std::string synopsis(const Subcommand& subcommand) {
  std::string line = fmt::format("\\fBsalbench {}\\fR", roff(subcommand.name));
  for (const Parameter& parameter : subcommand.parameters)
    if (!is_option(parameter)) line += fmt::format(" \\fI{}\\fR", roff(positional(parameter)));
  for (const Parameter& parameter : subcommand.parameters)
    if (is_option(parameter) && parameter.required)
      line += fmt::format(" \\fB{}\\fR \\fI{}\\fR", roff(parameter.name), placeholder(parameter));
  return line + " [\\fIOPTION\\fR...]";
}

std::string entry(const Parameter& parameter) {
  if (!is_option(parameter))
    return fmt::format(".TP\n\\fI{}\\fR\n{}\n", roff(parameter.name), roff(parameter.help));
  const std::string value = placeholder(parameter);
  return fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", roff(parameter.name),
                     value.empty() ? "" : " \\fI" + value + "\\fR", roff(parameter.help));
}

// A parameter that more than half of the subcommands have in the same words is described once.
class Common {
 public:
  explicit Common(const std::vector<Subcommand>& subcommands) : subcommands_(subcommands.size()) {
    for (const Subcommand& subcommand : subcommands)
      for (const Parameter& parameter : subcommand.parameters) ++count_[{parameter.name, parameter.help}];
  }
  bool has(const Parameter& parameter) const {
    const auto found = count_.find({parameter.name, parameter.help});
    return found != count_.end() && 2 * found->second > subcommands_;
  }

 private:
  std::map<std::pair<std::string, std::string>, std::size_t> count_;
  std::size_t subcommands_;
};

std::string common_section(const std::vector<Subcommand>& subcommands, const Common& common) {
  std::string text = ".SH COMMON OPTIONS\n";
  std::map<std::string, bool> seen;
  for (const Subcommand& subcommand : subcommands)
    for (const Parameter& parameter : subcommand.parameters)
      if (common.has(parameter) && !std::exchange(seen[parameter.name], true)) text += entry(parameter);
  return text +
         ".TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR\nprint the help, also that of a subcommand\n"
         ".TP\n\\fB\\-\\-version\\fR\nprint the version\n";
}

std::string subcommand_section(const Subcommand& subcommand, const Common& common) {
  std::string own, shared;
  for (const Parameter& parameter : subcommand.parameters) {
    if (!common.has(parameter))
      own += entry(parameter);
    else if (is_option(parameter))
      shared += fmt::format("{}\\fB{}\\fR", shared.empty() ? "" : ", ", roff(parameter.name));
  }
  std::string text = fmt::format(".SS {}\n{}\n.PP\n{}.\n", roff(subcommand.name), synopsis(subcommand),
                                 roff(subcommand.summary));
  if (!shared.empty()) text += fmt::format(".PP\nCommon options: {}.\n", shared);
  return text + own;
}

std::string words(const std::vector<std::string>& list) { return fmt::format("{}", fmt::join(list, " ")); }

}  // namespace

std::string manual_page(std::span<const SubcommandRow> rows, const std::string& version,
                        const std::string& date) {
  Arguments arguments;
  const std::vector<Subcommand> subcommands = described(rows, arguments);
  const Common common(subcommands);
  std::string page = fmt::format(
      ".TH SALBENCH 1 \"{}\" \"salbench {}\" \"User Commands\"\n.SH NAME\nsalbench, salbench\\-report \\- "
      "benchmark of "
      "3D saliency models\n.SH SYNOPSIS\n\\fBsalbench\\fR \\fISUBCOMMAND\\fR [\\fIOPTION\\fR...]\n.br\n"
      "\\fBsalbench\\-report\\fR \\fIOUT\\fR [\\fIOPTION\\fR...]\n.SH DESCRIPTION\n{}\n.PP\n{}",
      date, version, roff(kDescription), kAbout);
  page += common_section(subcommands, common);
  page += ".SH SUBCOMMANDS\n";
  for (const Subcommand& subcommand : subcommands) page += subcommand_section(subcommand, common);
  page += ".SH EXIT STATUS\n";
  for (const StatusMeaning& row : kStatusMeanings)
    page += fmt::format(".TP\n.B {}\n{}\n", row.status, roff(row.meaning));
  page += ".SH EXAMPLES\n";
  for (const Example& example : kExamples)
    page += fmt::format(".PP\n{}\n.EX\n    {}\n.EE\n", roff(example.remark), roff(example.line));
  return page + kFiles;
}

std::string bash_completion(std::span<const SubcommandRow> rows) {
  Arguments arguments;
  std::vector<std::string> names, cases, with_value;
  std::map<std::string, bool> seen;
  for (const Subcommand& subcommand : described(rows, arguments)) {
    names.push_back(subcommand.name);
    std::vector<std::string> options;
    for (const Parameter& parameter : subcommand.parameters) {
      if (!is_option(parameter)) continue;
      options.push_back(parameter.name);
      if (!placeholder(parameter).empty() && !std::exchange(seen[parameter.name], true))
        with_value.push_back(parameter.name);
    }
    cases.push_back(fmt::format("    {}) options='{} --help' ;;", subcommand.name, words(options)));
  }
  return fmt::format(kCompletion, words(names), fmt::join(cases, "\n"), fmt::join(with_value, " | "));
}

}  // namespace salbench
