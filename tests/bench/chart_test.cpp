#include "converters/bench/chart.h"

#include <cmath>

#include "converters/bench/gnuplot.h"
#include "converters/bench/label_layout.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

const std::string kNames =
    "scene,camera,rays,method,threads,rays_per_second,peak_bytes,miss_rate,depth_error_max";
const std::string kMore =
    ",hit_rate,false_hit_rate,wrong_cell_rate,wrong_voxel_rate,steps_per_ray,angle_degrees";

Chart chart_of(const std::string& csv, const ChartRows& rows = {}) {
  const Result<TextTable> table = parse_table(csv);
  REQUIRE(table);
  Result<Chart> chart = make_chart(*table, rows);
  INFO((chart ? "" : chart.error().message));
  REQUIRE(chart);
  return std::move(*chart);
}

/// What is said of a table that cannot be charted.
std::string complaint(const std::string& csv, const ChartRows& rows = {},
                      ErrorCode code = ErrorCode::kInvalidInput) {
  const Result<TextTable> table = parse_table(csv);
  const Result<Chart> chart = table ? make_chart(*table, rows) : Result<Chart>(table.error());
  REQUIRE(!chart);
  CHECK(chart.error().code == code);
  return chart.error().message;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("CSV is read with its head, quoted fields and either end of lines") {
  const auto table = parse_table("# date: x\r\n#y\n\na,\"b,\"\"c\"\"\",d\r\n1,,\"x\"\n# in between\n,2,3");
  REQUIRE(table);
  CHECK(table->head == std::vector<std::string>{" date: x", "y"});
  CHECK(table->columns == std::vector<std::string>{"a", "b,\"c\"", "d"});
  REQUIRE(table->rows.size() == 2);
  CHECK(table->rows[0].line == 5);
  CHECK(table->rows[0].fields == std::vector<std::string>{"1", "", "x"});
  CHECK(table->rows[1].fields == std::vector<std::string>{"", "2", "3"});
  CHECK(table->find("d") == 2u);
  CHECK(!table->find("e"));
  CHECK(**number_at(*table, table->rows[1], 2) == 3);
  CHECK(!*number_at(*table, table->rows[1], 0));
}

TEST_CASE("text that is no table of figures is told by its line") {
  CHECK(has(complaint(""), "no line of column names"));
  CHECK(has(complaint("# only a head\n"), "no line of column names"));
  CHECK(has(complaint(kNames + "\n"), "no rows"));
  CHECK(has(complaint(kNames + "\na,b,c\n"), "line 2: it has 3 fields"));
  CHECK(has(complaint(kNames + ",scene\n"), "'scene' is there twice"));
  CHECK(has(complaint(kNames + "\n\"a,b\n"), "line 2: a quoted text does not end"));
  CHECK(has(complaint("\"a\"b,c\n"), "line 1: there is text after a quoted one"));
  CHECK(has(complaint(std::string("a,b\n1,\0\n", 8)), "line 2: it has a byte"));
  CHECK(has(complaint(std::string(1000000, ',')), "over 1000 columns"));
  std::string rows = "a\n";
  for (int k = 0; k < 1000001; ++k) rows += "1\n";
  CHECK(has(complaint(rows), "over 1000000 rows"));
}

TEST_CASE("columns that are needed and figures that are none are named") {
  std::size_t begin = 0;
  while (begin < kNames.size()) {
    const std::size_t end = std::min(kNames.find(',', begin), kNames.size());
    const std::string name = kNames.substr(begin, end - begin);
    std::string names = kNames;
    names.replace(begin, name.size(), "other");
    CHECK(has(complaint(names + "\na,b,c,d,1,2,3,0,0\n"), "no column '" + name + "'"));
    begin = end + 1;
  }
  const std::string start = kNames + "\ns,c,primary,exact,";
  for (const std::string bad : {"nan", "inf", "-1", "1e999", "0x10", "1 ", "one"}) {
    CAPTURE(bad);
    CHECK(has(complaint(start + "1," + bad + ",3,0,0\n"), "in column rays_per_second is no number"));
  }
  CHECK(has(complaint(start + ",2,3,0,0\n"), "line 2: column threads is empty"));
  CHECK(has(complaint(start + "1e30,2,3,0,0\n"), "threads"));
  CHECK(has(complaint(start + "1,0,3,0,0\n"), "must be above 0"));
  CHECK(has(complaint(start + "1,2,3,1.5,0\n"), "share of rays is above 1"));
  CHECK(has(complaint(kNames + "\ns,c,primary,,1,2,3,0,0\n"), "names no method"));
  std::string many = kNames + "\n";
  for (int k = 0; k < 101; ++k) many += "s,c,primary,m" + std::to_string(k) + ",1,2,3,0,0\n";
  CHECK(has(complaint(many), "over 100 methods"));
}

TEST_CASE("figures are medians and ranges over scenes and cameras, of primary rays and most threads") {
  const std::string csv = "# processor: Fast One\n" + kNames + kMore +
                          "\na,full,primary,exact,2,10,100,0,0,0.5,0,0,0,20,40"
                          "\na,graze,primary,exact,2,30,100,0,0,0.5,0,0,0,50,5"
                          "\nb,full,primary,exact,2,20,300,0,0,0.5,0,0,0,10,41"
                          "\na,full,primary,exact,1,5,100,0,0,0.5,0,0,0,20,40"
                          "\na,full,diffuse,exact,2,7,100,0,0,0.5,0,0,0,20,40"
                          "\na,full,primary,mask,2,1,900,0.1,2.5,0.5,0.02,,0.2,,40\n";
  const Chart chart = chart_of(csv);
  CHECK(chart.processor == "Fast One");
  CHECK(chart.subject == "2 scenes, 2 cameras, primary rays, 2 threads");
  CHECK(chart.steps_scene == "a");
  REQUIRE(chart.methods.size() == 2);
  const ChartMethod& exact = chart.methods[0];
  CHECK(exact.name == "exact");
  CHECK(exact.rows == 3);
  CHECK(exact.speed.median == 20);
  CHECK(exact.speed.low == 10);
  CHECK(exact.speed.high == 30);
  CHECK(exact.memory.median == 100);
  CHECK(exact.error.median == 0);
  CHECK(exact.steps == std::vector<std::pair<double, double>>{{5, 50}, {40, 20}});
  // Missed 0.1 of half the rays; of the rest a fifth are of another voxel; 0.02 of the other half is hit by
  // mistake.
  const ChartMethod& mask = chart.methods[1];
  CHECK(std::abs(mask.error.median - (0.05 + 0.5 * 0.9 * 0.2 + 0.01)) < 1e-12);
  CHECK(mask.steps.empty());
  CHECK(chart_of(csv, {.scene = "a", .camera = "", .rays = "", .threads = {}, .error = ChartError::kDepth})
            .methods[1]
            .error.median == 2.5);

  ChartRows wanted;
  wanted.threads = 1;
  CHECK(chart_of(csv, wanted).methods[0].speed.median == 5);
  wanted = {};
  wanted.rays = "diffuse";
  CHECK(chart_of(csv, wanted).subject == "a, camera full, diffuse rays, 2 threads");
  wanted = {};
  wanted.scene = "c";
  CHECK(has(complaint(csv, wanted, ErrorCode::kUsage), "there are a, b"));
  wanted = {};
  wanted.threads = 7;
  CHECK(has(complaint(csv, wanted, ErrorCode::kUsage), "no rows of 7 threads"));
}

TEST_CASE("the columns that scripts rely on are enough, errors are then hits missed") {
  const Chart chart = chart_of(kNames + "\ns,c,shadow,exact,4,1e6,1e6,0,\ns,c,shadow,m,4,2e6,1e6,0.25,3\n");
  CHECK(chart.only_missed);
  CHECK(chart.subject == "s, camera c, shadow rays, 4 threads");
  CHECK(chart.methods[1].error.median == 0.25);
  CHECK(has(chart_script(chart, {}), "hits that are missed"));
  CHECK(!has(chart_script(chart, {}), "Steps against angle"));
}

TEST_CASE("names of others are no commands to gnuplot") {
  CHECK(gnuplot_text("lod:1px") == "'lod:1px'");
  CHECK(gnuplot_text("a'; system('x') #`y`\"$\\\n") == "'a?; system(?x?) \?\?y\?\?\?\?\?'");
  CHECK(gnuplot_text("\xc3\xa9") == "'\?\?'");
  CHECK(gnuplot_text(std::string(1000, 'x')).size() == 122);
  const std::string name = "m'`touch /tmp/x`\nset output";
  const Chart chart =
      chart_of("# processor: '`y`\n" + kNames + "\n\"s'`\",\"c\"\"'\",primary,\"m'`touch x`\",1,1,1,0,0\n");
  const std::string script = chart_script(chart, {});
  CHECK(!has(script, "`"));
  CHECK(!has(script, "m'"));
}

TEST_CASE("labels stay in the picture and off points and each other") {
  std::vector<LabelAnchor> points;
  for (int k = 0; k < 12; ++k)
    points.push_back({"method-" + std::to_string(k), 20.0 + 35 * (k % 4), 30.0 + 60 * (k / 4)});
  points.push_back({"at the right", 495, 100});
  const PixelBox area{0, 0, 500, 220};
  const std::vector<PlacedLabel> labels = place_labels(points, {}, area);
  REQUIRE(labels.size() == points.size());
  for (std::size_t k = 0; k < labels.size(); ++k) {
    CHECK(labels[k].text == points[k].text);
    CHECK(labels[k].x >= area.x0);
    CHECK(labels[k].x + text_width(labels[k].text) <= area.x1);
    for (std::size_t j = 0; j < k; ++j) {
      const bool apart = std::abs(labels[k].y - labels[j].y) >= 12 ||
                         labels[k].x >= labels[j].x + text_width(labels[j].text) ||
                         labels[j].x >= labels[k].x + text_width(labels[k].text);
      CHECK(apart);
    }
  }
}
