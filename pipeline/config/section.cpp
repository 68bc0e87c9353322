// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/config/section.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "io/file.h"
#include "io/shapes/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {

struct Section::Impl {
  Impl(const YAML::Node& mapping, std::string its_file, std::string its_path, std::string its_folder)
      : node(mapping),
        line(node.Mark().line + 1),
        file(std::move(its_file)),
        path(std::move(its_path)),
        folder(std::move(its_folder)) {
    for (auto it = node.begin(); it != node.end(); ++it) entries.emplace(it->first.Scalar(), it);
  }

  YAML::Node node;
  int line;
  std::string file;
  std::string path;  // "models.PS"; empty at the root
  std::string folder;
  // Sorted by key: yaml-cpp searches linearly, and its operator[] would insert nodes.
  std::map<std::string, YAML::const_iterator, std::less<>> entries;

  std::string full_key(std::string_view key) const {
    return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
  }

  // Entry of a key, or the node's end.
  YAML::const_iterator entry(std::string_view key) const {
    const auto found = entries.find(key);
    return found == entries.end() ? node.end() : found->second;
  }
  int line_of(std::string_view key) const {
    const auto it = entry(key);
    return it == node.end() ? line : 1 + it->first.Mark().line;
  }
};

namespace {

constexpr std::size_t kMaxBytes = 1U << 20U;   // size limit of a configuration; a complete one has 20 kB
constexpr std::size_t kMaxRecord = 1U << 26U;  // size limit of a run's record, which has a line for each odd
                                               // shape
constexpr std::size_t kMostUnknown = 10;       // unknown keys reported per mapping

// Messages are one line, but keys and values of YAML may hold line ends and control characters.
[[noreturn]] void fail_at(const std::string& file, int line, std::string what) {
  constexpr std::size_t kShown = 500;
  if (what.size() > 2 * kShown) what.replace(kShown, what.size() - 2 * kShown, "...");
  const auto is_control = [](unsigned char c) { return c < ' ' || c == 0x7f; };
  std::ranges::replace_if(what, is_control, '?');
  throw SectionError(fmt::format("{}:{}", file, line), what);
}

// NUL would end a path early, so that another file is read or written.
bool has_nul(const YAML::Node& node) {
  return node.IsScalar() && node.Scalar().find('\0') != std::string::npos;
}
constexpr const char* kHasNul = "has the character U+0000: no name and no path may have it";

void check_mapping(const YAML::Node& node, const std::string& file, const std::string& path) {
  if (node.IsNull()) return;
  const std::string what = path.empty() ? "the file" : path;
  const int line = node.Mark().line + 1;
  if (!node.IsMap()) fail_at(file, line, what + " must be a mapping of keys to values");
  std::set<std::string> seen;
  for (const auto& entry : node) {
    if (!entry.first.IsScalar()) fail_at(file, line, what + " has a key that is not a plain word");
    const std::string& key = entry.first.Scalar();
    if (!seen.insert(key).second)
      fail_at(file, entry.first.Mark().line + 1, fmt::format("the key '{}' is given twice", key));
    if (has_nul(entry.first) || has_nul(entry.second))
      fail_at(file, entry.first.Mark().line + 1,
              fmt::format("{}{}{} {}", path, path.empty() ? "" : ".", key, kHasNul));
  }
}

// True if the line, counted from 0, has a tab in its indentation.
bool has_tab_before_text(const std::string& text, int line) {
  const std::vector<std::string> lines = lines_in(text);
  if (line < 0 || static_cast<std::size_t>(line) >= lines.size()) return false;
  const std::string& written = lines[static_cast<std::size_t>(line)];
  return written.substr(0, written.find_first_not_of(" \t")).find('\t') != std::string::npos;
}

// Finds a second document with content. Documents without any are no fault.
class Documents : public YAML::EventHandler {
 public:
  const YAML::Mark& start() const { return start_; }  // start of the last document
  const std::optional<YAML::Mark>& second() const { return second_; }

  void OnDocumentStart(const YAML::Mark& mark) override {
    ++count_;
    start_ = mark;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { add(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& /*value*/) override {
    add(mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override {
    add(mark);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {
    add(mark);
  }
  void OnMapEnd() override {}

 private:
  void add(const YAML::Mark& mark) {
    if (count_ > 1 && !second_) second_ = mark;
  }

  std::size_t count_ = 0;
  YAML::Mark start_;
  std::optional<YAML::Mark> second_;
};

// Returns where a second document has its first content. The parser does not move past a comma outside of
// brackets, so that YAML::LoadAll would not end: such a comma is refused.
std::optional<YAML::Mark> second_document(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  Documents documents;
  for (int last = -1; parser.HandleNextDocument(documents); last = documents.start().pos)
    if (documents.start().pos == last)
      throw YAML::ParserException(documents.start(), "a comma outside of brackets");
  return documents.second();
}

YAML::Node parse_yaml(const std::string& file, const std::string& text) {
  const std::size_t most = is_record_text(text) ? kMaxRecord : kMaxBytes;
  if (text.size() > most) fail_at(file, 1, fmt::format("more than the {} bytes that can be read", most));
  try {
    if (const auto second = second_document(text))
      fail_at(file, second->line + 1,
              "belongs to a second document, which a line '---' above begins: remove that line");
    YAML::Node node = YAML::Load(text);
    check_mapping(node, file, "");
    return node;
  } catch (const YAML::DeepRecursion& error) {
    fail_at(file, error.mark.line + 1,
            fmt::format("{} levels of mappings and lists are too many", error.depth()));
  } catch (const YAML::Exception& error) {
    const int line = error.mark.line;
    const bool by_tab = has_tab_before_text(text, line) || has_tab_before_text(text, line - 1);
    fail_at(file, line + 1,
            fmt::format("not valid YAML: {}{}", error.msg,
                        by_tab ? "; a tab is no indentation: use blanks" : ""));
  }
}

}  // namespace

void SectionErrors::throw_any() const {
  if (errors_.empty()) return;
  if (errors_.size() == 1) throw errors_[0];
  std::vector<std::string> lines;
  for (const SectionError& error : errors_)
    for (const std::string& line : lines_in(error.what()))
      if (std::ranges::find(lines, line) == lines.end())
        lines.push_back(line);  // a variant also has its model's options
  std::ranges::stable_sort(lines, natural_less);
  if (errors_.size() == most_) lines.back() += "; there may be more";
  const std::size_t where = lines[0].find(": ");
  SectionError all(lines[0].substr(0, where), fmt::format("{}", fmt::join(lines, "\n")).substr(where + 2));
  all.what_is_wrong = errors_[0].what_is_wrong;
  throw all;
}

bool is_record_text(std::string_view text) {
  if (text.starts_with(kUnderWay)) return true;
  while (text.starts_with('#')) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return false;
    text.remove_prefix(end + 1);
  }
  return text.starts_with("program: salbench ");
}

Section Section::from_file(const std::string& path) {
  try {
    return from_text(read_head(path, kMaxRecord + 1), path);
  } catch (const InputError& error) {
    throw ConfigError(error.what());
  }
}

Section Section::from_text(const std::string& yaml, const std::string& name) {
  return Section(std::make_shared<Impl>(parse_yaml(name, yaml), name, "",
                                        std::filesystem::path(name).parent_path().string()));
}

std::vector<std::string> Section::keys() const {
  std::vector<std::string> result;
  for (const auto& entry : impl_->node) result.push_back(entry.first.Scalar());
  return result;
}

bool Section::has(std::string_view key) const { return impl_->entry(key) != impl_->node.end(); }

Section Section::child(std::string_view key) const {
  const auto it = impl_->entry(key);
  const YAML::Node node = it == impl_->node.end() ? YAML::Node() : it->second;
  check_mapping(node, impl_->file, impl_->full_key(key));
  return Section(std::make_shared<Impl>(node, impl_->file, impl_->full_key(key), impl_->folder));
}

Section Section::child_or_names(std::string_view key) const {
  const auto it = impl_->entry(key);
  const YAML::Node node = it == impl_->node.end() ? YAML::Node() : it->second;
  if (!node.IsSequence() && !node.IsScalar()) return child(key);
  YAML::Node made(YAML::NodeType::Map);  // nodes of the file, which carry line numbers
  if (node.IsScalar()) made.force_insert(node, YAML::Node());
  for (const YAML::Node& name : node) {
    if (!name.IsScalar()) fail(key, "must be a list of names, or a mapping: {a: , b: {option: value}}");
    made.force_insert(name, YAML::Node());
  }
  check_mapping(made, impl_->file, impl_->full_key(key));
  return Section(std::make_shared<Impl>(made, impl_->file, impl_->full_key(key), impl_->folder));
}

std::optional<std::string> Section::text(std::string_view key) const {
  const auto it = impl_->entry(key);
  if (it == impl_->node.end()) return {};
  if (!it->second.IsScalar()) fail(key, "must be one value");
  return it->second.Scalar();
}

bool Section::has_mapping(std::string_view key) const {
  const auto it = impl_->entry(key);
  if (it == impl_->node.end()) return false;
  const YAML::Node node = it->second;
  return node.IsMap() || node.IsNull();
}

Words Section::words(std::string_view key) const {
  const auto it = impl_->entry(key);
  if (it == impl_->node.end()) return {};
  const YAML::Node node = it->second;
  if (node.IsScalar()) return {node.Scalar()};
  if (!node.IsSequence()) fail(key, "must be a list of names, such as [a, b]");
  Words words;
  for (const YAML::Node& word : node) {
    if (!word.IsScalar()) fail(key, "must be a list of names, such as [a, b]");
    if (has_nul(word)) fail(key, kHasNul);
    words.push_back(word.Scalar());
  }
  return words;
}

std::vector<Section> Section::combinations(std::string_view key, std::size_t most) const {
  const Section lists = child(key);
  if (lists.keys().empty()) fail(key, "must be a mapping of options to lists of values");
  std::vector<std::vector<YAML::Node>> chosen = {{}};  // values in the order of the options
  for (const auto& option : lists.impl_->node) {
    const YAML::Node values = option.second;
    const std::string& name = option.first.Scalar();
    if (!values.IsSequence()) lists.fail(name, "must be a list of values");
    if (values.size() == 0) lists.fail(name, "is an empty list");
    if (values.size() > most / chosen.size())
      fail(key, fmt::format("has more than the {} combinations that can be", most));
    std::vector<std::vector<YAML::Node>> longer;
    for (const std::vector<YAML::Node>& before : chosen)
      for (const YAML::Node& value : values) longer.emplace_back(before).push_back(value);
    chosen = std::move(longer);
  }
  std::vector<Section> sections;
  for (const std::vector<YAML::Node>& values : chosen) {
    YAML::Node made(YAML::NodeType::Map);  // nodes of the file, which carry line numbers
    for (const auto& entry : impl_->node)
      if (entry.first.Scalar() != key) made.force_insert(entry.first, entry.second);
    auto value = values.begin();
    for (const auto& option : lists.impl_->node) made.force_insert(option.first, *value++);
    check_mapping(made, impl_->file, impl_->path);
    auto impl = std::make_shared<Impl>(made, impl_->file, impl_->path, impl_->folder);
    impl->line = impl_->line_of(key);
    sections.push_back(Section(std::move(impl)));
  }
  return sections;
}

std::vector<Section> Section::list(std::string_view key) const {
  const auto it = impl_->entry(key);
  if (it == impl_->node.end()) return {};
  const YAML::Node node = it->second;
  if (node.IsMap()) return {child(key)};
  if (!node.IsSequence()) fail(key, "must be a list of mappings");
  std::vector<Section> sections;
  for (const YAML::Node& element : node) {
    const std::string path = fmt::format("{}[{}]", impl_->full_key(key), sections.size());
    check_mapping(element, impl_->file, path);
    sections.push_back(Section(std::make_shared<Impl>(element, impl_->file, path, impl_->folder)));
  }
  return sections;
}

std::string Section::folder() const { return impl_->folder; }

Section Section::as_if_in(const std::string& folder) const {
  return Section(std::make_shared<Impl>(impl_->node, impl_->file, impl_->path, folder));
}

std::string Section::where(std::string_view key) const {
  return fmt::format("{}:{}", impl_->file, impl_->line_of(key));
}

void Section::fail(std::string_view key, std::string_view what) const {
  fail_at(impl_->file, impl_->line_of(key), fmt::format("{} {}", impl_->full_key(key), what));
}

void Section::reject_unknown(const std::vector<std::string_view>& known) const {
  SectionErrors errors(kMostUnknown);
  for (const std::string& key : keys()) {
    if (std::ranges::find(known, key) != known.end()) continue;
    errors.gather([&] {
      fail(key, "is not a known key; " +
                    did_you_mean(key, known, fmt::format("known are: {}", fmt::join(known, ", "))));
    });
  }
  errors.throw_any();
}

}  // namespace salbench
