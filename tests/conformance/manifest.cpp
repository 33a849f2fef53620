#include "tests/conformance/manifest.h"

#include <map>
#include <stdexcept>

namespace mesocell::conformance {
namespace {

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;  // no text here has control characters
  }
  return result + "\"";
}

/// As much of JSON as a manifest needs: objects, arrays, strings and whole numbers.
class JsonReader {
 public:
  explicit JsonReader(std::string_view json) : json_(json) {}

  /// Calls `member(key)` for every member of an object, at its value.
  template <typename Member>
  void object(Member member) {
    list('{', '}', [&] {
      const std::string key = string();
      expect(':');
      member(key);
    });
  }
  /// Calls `element()` at every element of an array.
  template <typename Element>
  void array(Element element) {
    list('[', ']', element);
  }
  std::string string() {
    expect('"');
    std::string text;
    while (at_ < json_.size() && json_[at_] != '"') {
      if (json_[at_] == '\\') ++at_;
      if (at_ < json_.size()) text += json_[at_++];
    }
    expect('"');
    return text;
  }
  std::uint64_t number() {
    skip_blanks();
    const std::size_t begin = at_;
    std::uint64_t value = 0;
    for (; at_ < json_.size() && json_[at_] >= '0' && json_[at_] <= '9'; ++at_)
      value = value * 10 + std::uint64_t(json_[at_] - '0');
    if (at_ == begin) fail("a number");
    return value;
  }
  void end() {
    skip_blanks();
    if (at_ != json_.size()) fail("the end");
  }
  [[noreturn]] void fail(const std::string& expected) const {
    throw std::runtime_error("not a manifest: " + expected + " is expected at byte " + std::to_string(at_));
  }

 private:
  void skip_blanks() {
    while (at_ < json_.size() && std::string_view(" \n\r\t").find(json_[at_]) != std::string_view::npos)
      ++at_;
  }
  bool take(char c) {
    skip_blanks();
    if (at_ == json_.size() || json_[at_] != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail(std::string("'") + c + "'");
  }
  template <typename Element>
  void list(char open, char close, Element element) {
    expect(open);
    if (take(close)) return;
    do element();
    while (take(','));
    expect(close);
  }

  std::string_view json_;
  std::size_t at_ = 0;
};

Rule read_rule(JsonReader& in) {
  Rule rule;
  const std::map<std::string, std::string*> fields = {
      {"id", &rule.id}, {"clause", &rule.clause}, {"severity", &rule.severity}, {"text", &rule.text}};
  in.object([&](const std::string& key) {
    const auto at = fields.find(key);
    if (at == fields.end()) in.fail("another key than " + key);
    *at->second = in.string();
  });
  return rule;
}

/// What most files are reported for; other reports are written out.
std::vector<std::string> usual_report(const Entry& entry) {
  if (entry.issue.empty()) return {};
  return {entry.issue};
}

Entry read_entry(JsonReader& in) {
  Entry entry;
  bool has_report = false;
  const std::map<std::string, std::string*> fields = {{"path", &entry.path},     {"verdict", &entry.verdict},
                                                      {"clause", &entry.clause}, {"issue", &entry.issue},
                                                      {"xxh64", &entry.xxh64},   {"digest", &entry.digest}};
  in.object([&](const std::string& key) {
    if (key == "bytes") {
      entry.bytes = in.number();
    } else if (key == "report") {
      has_report = true;
      in.array([&] { entry.report.push_back(in.string()); });
    } else if (const auto at = fields.find(key); at != fields.end()) {
      *at->second = in.string();
    } else {
      in.fail("another key than " + key);
    }
  });
  if (!has_report) entry.report = usual_report(entry);
  return entry;
}

}  // namespace

std::string Manifest::rule_text(std::string_view issue) const {
  for (const Rule& rule : rules)
    if (rule.id == issue) return rule.text;
  return {};
}

std::string to_json(const Manifest& manifest) {
  std::string json = "{\n\"version\": " + quoted(manifest.version) + ",\n\"rules\": [\n";
  for (const Rule& rule : manifest.rules) {
    json += "{\"id\": " + quoted(rule.id) + ", \"clause\": " + quoted(rule.clause) +
            ", \"severity\": " + quoted(rule.severity) + ", \"text\": " + quoted(rule.text) + "}";
    json += &rule == &manifest.rules.back() ? "\n" : ",\n";
  }
  json += "],\n\"files\": [\n";
  for (const Entry& entry : manifest.files) {
    json += "{\"path\": " + quoted(entry.path) + ", \"bytes\": " + std::to_string(entry.bytes) +
            ", \"xxh64\": " + quoted(entry.xxh64) + ", \"verdict\": " + quoted(entry.verdict) +
            ", \"clause\": " + quoted(entry.clause);
    if (!entry.issue.empty()) json += ", \"issue\": " + quoted(entry.issue);
    if (entry.report != usual_report(entry)) {
      json += ", \"report\": [";
      for (const std::string& id : entry.report)
        json += (&id == &entry.report.front() ? "" : ", ") + quoted(id);
      json += "]";
    }
    if (!entry.digest.empty()) json += ", \"digest\": " + quoted(entry.digest);
    json += &entry == &manifest.files.back() ? "}\n" : "},\n";
  }
  return json + "]\n}\n";
}

Manifest parse_manifest(std::string_view json) {
  Manifest manifest;
  JsonReader in(json);
  in.object([&](const std::string& key) {
    if (key == "version") {
      manifest.version = in.string();
    } else if (key == "rules") {
      in.array([&] { manifest.rules.push_back(read_rule(in)); });
    } else if (key == "files") {
      in.array([&] { manifest.files.push_back(read_entry(in)); });
    } else {
      in.fail("another key than " + key);
    }
  });
  in.end();
  return manifest;
}

std::string hex16(std::uint64_t value) {
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; value >>= 4) text[i] = "0123456789abcdef"[value & 15];
  return text;
}

}  // namespace mesocell::conformance
