#include "converters/stability/report.h"

#include <algorithm>
#include <string>

#include "tests/stability/occurrences.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

std::vector<StabilityResult> some_results() {
  const IsolatedRun done{RunOutcome::kDone, "", 0.5, 0.9, 1000};
  return {
      {"clean", "clean", "", "a", "parity-x", {4, 4, 4}, done, {0, 0, 10, 20, 64}},
      {"clean", "clean", "", "a", "ours", {4, 4, 4}, done, {1, 0, 10, 20, 64}},
      {"clean", "clean", "", "b", "parity-x", {4, 4, 4}, done, {5, 2, 10, 20, 64}},
      {"clean", "clean", "", "b", "ours", {4, 4, 4}, done, {0, 0, 10, 20, 64}},
      {"damage",
       "odd, \"quoted\" <&>|",
       "1 %",
       "a",
       "parity-x",
       {4, 4, 4},
       {RunOutcome::kTooLong, "", 9, 0, 0},
       {}},
      {"damage",
       "odd, \"quoted\" <&>|",
       "1 %",
       "a",
       "ours",
       {4, 4, 4},
       {RunOutcome::kFailed, "no\nmemory", 1, 0, 0},
       {}},
  };
}

/// Fields of CSV, by lines.
std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
  std::vector<std::vector<std::string>> lines(1, {""});
  bool quoted = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (quoted && c == '"' && k + 1 < text.size() && text[k + 1] == '"')
      lines.back().back() += text[++k];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      lines.back().emplace_back();
    else if (c == '\n' && !quoted)
      lines.push_back({""});
    else
      lines.back().back() += c;
  }
  lines.pop_back();
  return lines;
}

}  // namespace

TEST_CASE("results of several meshes are joined in a table") {
  const StabilityTable table = tabulate(some_results());
  CHECK(table.methods == std::vector<std::string>{"parity-x", "ours"});
  REQUIRE(table.rows.size() == 2);
  CHECK(table.rows[0].name == "clean");
  CHECK(cell_text(table.rows[0].cells[0]) == "25");
  CHECK(table.rows[0].cells[0].voxels.wrong_far_percent() == 5);
  CHECK(cell_text(table.rows[0].cells[1]) == "5.0");
  CHECK(cell_text(table.rows[1].cells[0]) == "too long");
  CHECK(cell_text(table.rows[1].cells[1]) == "failed");
}

TEST_CASE("CSV has a line a result and as many fields in each") {
  const auto lines = parse_csv(stability_csv(some_results()));
  REQUIRE(lines.size() == 7);
  for (const auto& line : lines) CHECK(line.size() == lines[0].size());
  CHECK(lines[3][0] == "clean");
  CHECK(lines[3][9] == "5");
  CHECK(lines[0][9] == "wrong");
  CHECK(lines[5][1] == "odd, \"quoted\" <&>|");
  CHECK(lines[6].back() == "no\nmemory");
}

TEST_CASE("Markdown has two tables of all rows") {
  const std::string text = stability_markdown(tabulate(some_results()));
  CHECK(occurrences(text, "| clean | ") == 2);
  CHECK(occurrences(text, "<&>\\| 1 % |") == 2);
  CHECK(text.find("| 25 | 5.0 |") != text.npos);
  CHECK(occurrences(benchmark_markdown(some_results()), "\n") == 8);
}

TEST_CASE("the heat map is well-formed and has a cell for each result") {
  const std::string svg = stability_heat_map(tabulate(some_results()), "a & b");
  CHECK(svg.starts_with("<svg "));
  CHECK(svg.ends_with("</svg>\n"));
  CHECK(occurrences(svg, "<text") == occurrences(svg, "</text>"));
  CHECK(occurrences(svg, "<rect") == 1 + 4 + 7);  // the ground, the cells, the scale
  CHECK(occurrences(svg, "too long") == 1);
  CHECK(svg.find("a &amp; b") != svg.npos);
  CHECK(svg.find("&quot;quoted&quot; &lt;&amp;&gt;") != svg.npos);
}

TEST_CASE("small shares are not told as none") {
  CHECK(percent_text(0) == "0");
  CHECK(percent_text(1e-9) == "<0.01");
  CHECK(percent_text(0.034) == "0.03");
  CHECK(percent_text(0.999) == "1.0");
  CHECK(percent_text(3.14159) == "3.1");
  CHECK(percent_text(9.97) == "10");
  CHECK(percent_text(123.4) == "123");
}
