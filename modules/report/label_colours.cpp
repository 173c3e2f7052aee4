#include "report/label_colours.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace stackmesh {
namespace {

std::string hex(double red, double green, double blue) {
  const auto byte = [](double x) { return static_cast<int>(std::lround(255 * std::clamp(x, 0.0, 1.0))); };
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", byte(red), byte(green), byte(blue));
  return text;
}

/// A colour of Oklab's cylinder: lightness and chroma from 0, hue in turns.
std::string oklch(double lightness, double chroma, double hue) {
  const double a = chroma * std::cos(6.283185307179586 * hue), b = chroma * std::sin(6.283185307179586 * hue);
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3),
               m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3),
               s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  const auto gamma = [](double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; };
  return hex(gamma(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
             gamma(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
             gamma(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s));
}

}  // namespace

std::vector<std::string> label_colours(const std::vector<LabelInfo>& labels) {
  std::vector<std::string> colours;
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const LabelInfo& l = labels[k];
    if (l.number == 0) {
      colours.push_back("#9a9a9a");
    } else if (l.colour) {
      colours.push_back(hex((*l.colour)[0] / 255.0, (*l.colour)[1] / 255.0, (*l.colour)[2] / 255.0));
    } else {
      const double n = static_cast<double>(k) - 1;  // hues a golden section apart; three lightnesses in turn
      colours.push_back(oklch(0.66 - 0.08 * std::fmod(n, 3), 0.13, std::fmod(0.08 + n * 0.6180339887, 1)));
    }
  }
  return colours;
}

}  // namespace stackmesh
