// Writes a closed tube along a trefoil knot to stdout as an OFF mesh: a model that needs no download.
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace {

using Vec = std::array<double, 3>;

constexpr int kAround = 480, kAcross = 48;
constexpr double kRadius = 0.4;

Vec curve(double t) {
  return {std::sin(t) + 2 * std::sin(2 * t), std::cos(t) - 2 * std::cos(2 * t), -std::sin(3 * t)};
}

Vec tangent(double t) {
  return {std::cos(t) + 4 * std::cos(2 * t), -std::sin(t) + 4 * std::sin(2 * t), -3 * std::cos(3 * t)};
}

Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vec unit(const Vec& a) {
  const double l = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  return {a[0] / l, a[1] / l, a[2] / l};
}

}  // namespace

int main() {
  constexpr double kTurn = 2 * std::numbers::pi;
  std::printf("OFF\n%d %d 0\n", kAround * kAcross, 2 * kAround * kAcross);
  for (int i = 0; i < kAround; ++i) {
    const double t = kTurn * i / kAround;
    const Vec centre = curve(t), along = unit(tangent(t));
    // The knot never runs along z, so this frame turns without a jump and closes.
    const Vec side = unit(cross(along, {0, 0, 1})), up = cross(side, along);
    for (int j = 0; j < kAcross; ++j) {
      const double c = kRadius * std::cos(kTurn * j / kAcross), s = kRadius * std::sin(kTurn * j / kAcross);
      std::printf("%.9g %.9g %.9g\n", centre[0] + c * side[0] + s * up[0],
                  centre[1] + c * side[1] + s * up[1], centre[2] + c * side[2] + s * up[2]);
    }
  }
  const auto at = [](int i, int j) { return i % kAround * kAcross + j % kAcross; };
  for (int i = 0; i < kAround; ++i)
    for (int j = 0; j < kAcross; ++j) {
      std::printf("3 %d %d %d\n", at(i, j), at(i + 1, j + 1), at(i, j + 1));
      std::printf("3 %d %d %d\n", at(i, j), at(i + 1, j), at(i + 1, j + 1));
    }
}
