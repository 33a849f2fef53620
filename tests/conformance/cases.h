#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "format/limits.h"
#include "tests/format/test_file.h"

/// The cases of the conformance suite, as data: files of which it is known what a reader must say.
namespace mesocell::test {

inline constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

struct Case {
  std::string name;         ///< unique: topic or issue id, slash, what is special
  std::string_view clause;  ///< of spec/mesocell-1.md
  std::string_view issue;   ///< id that the case is for; empty for a valid file without remarks
  bool sole = false;        ///< no other error is in the file: a reader that forgets this rule takes it
  Bytes bytes;
  ReadLimits limits;
  std::string_view version = "1.0";  ///< of the format, that brought what the case is about
};

/// Collects cases. Clause and severity of an issue come from the catalogue.
class CaseList {
 public:
  /// A valid file; `issue`: a warning or remark that it gets.
  void valid(std::string_view name, std::string_view clause, Bytes bytes, std::string_view issue = {},
             const ReadLimits& limits = {});
  /// A file with one fault and no other. The issue's id is the name's part before the slash.
  void fault(std::string_view name, Bytes bytes, const ReadLimits& limits = {});
  /// A file with this fault among others that come with it.
  void faults(std::string_view name, Bytes bytes, const ReadLimits& limits = {});
  /// A file that is valid but for these limits.
  void limit(std::string_view name, Bytes bytes, const ReadLimits& limits = {});

  /// The version of the cases that follow.
  void of_version(std::string_view version) { version_ = version; }

  [[nodiscard]] std::vector<Case> release() { return std::move(cases_); }

 private:
  void add_invalid(std::string_view name, bool sole, Bytes bytes, const ReadLimits& limits);
  std::vector<Case> cases_;
  std::string_view version_ = "1.0";
};

/// "invalid", "valid" or "limit".
[[nodiscard]] std::string_view verdict_of(const Case& c);
/// All cases, always in the same order and with the same bytes but for those that the zstd library made.
[[nodiscard]] std::vector<Case> conformance_cases();

// A source file each.
void add_header_cases(CaseList& cases);
void add_asset_cases(CaseList& cases);
void add_directory_cases(CaseList& cases);
void add_layout_cases(CaseList& cases);
void add_block_cases(CaseList& cases);
void add_zstd_cases(CaseList& cases);
void add_grid_cases(CaseList& cases);
void add_tile_cases(CaseList& cases);
void add_piece_cases(CaseList& cases);
void add_membership_cases(CaseList& cases);
void add_text_cases(CaseList& cases);
void add_color_cases(CaseList& cases);
void add_normal_cases(CaseList& cases);
void add_version_cases(CaseList& cases);
void add_mesh_cases(CaseList& cases);
void add_surface_color_cases(CaseList& cases);

}  // namespace mesocell::test
