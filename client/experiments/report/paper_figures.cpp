#include "client/experiments/report/paper_figures.hpp"

#include <algorithm>

namespace kinship::experiments {
namespace {

const PaperTable kPlanar = {{"planar_5r_a", "planar_5r_b", "planar_7r_c"},
                            {
                                // uniform
                                {0.42, 0.2, 5176, 2830, 758.9, 192.4},
                                {0.49, 0.27, 4695, 2867, 890.4, 220.4},
                                {1.57, 0.78, 20354, 10692, 968.1, 280.5},
                                // planar_5r_a
                                {0.38, 0.21, 2356, 1409, 732.9, 187},
                                {0.32, 0.15, 1862, 952, 848.6, 199.6},
                                {0.8, 0.59, 3940, 2971, 897.4, 223.7},
                                // planar_5r_b
                                {0.3, 0.17, 1863, 1128, 777.5, 194},
                                {0.3, 0.14, 1772, 871, 880, 226.3},
                                {0.46, 0.25, 2204, 1229, 873.9, 224.9},
                                // planar_7r_c
                                {0.38, 0.26, 2367, 1669, 747.2, 212.8},
                                {0.34, 0.16, 2054, 977, 886.9, 218.7},
                                {0.78, 0.54, 3786, 2640, 882.8, 246.6},
                            }};

const PaperTable kCobots = {{"sara_like", "iiwa14", "ur10e", "panda", "sawyer"},
                            {
                                // uniform
                                {0.8, 0.73, 5689, 5114, 880.99, 388.82},
                                {0.79, 0.73, 8054, 7313, 947.69, 457.51},
                                {2.51, 2.51, 11604, 11421, 1065.13, 419.81},
                                {1.08, 0.96, 10321, 8984, 884.91, 392.87},
                                {2.59, 2.34, 9155, 8230, 1038.26, 454.9},
                                // sara_like
                                {0.59, 0.5, 3667, 3089, 816.39, 418.01},
                                {0.38, 0.29, 3602, 2733, 846.28, 412.26},
                                {1.22, 0.99, 4763, 3790, 791.32, 348.72},
                                {0.69, 0.64, 5678, 5076, 679.5, 297.53},
                                {1.5, 1.18, 4802, 3732, 909.09, 437.16},
                                // iiwa14
                                {0.42, 0.34, 2827, 2242, 819.79, 420.43},
                                {0.32, 0.24, 2959, 2157, 781.57, 402.76},
                                {0.64, 0.52, 2707, 2166, 776.25, 339.86},
                                {0.49, 0.51, 4109, 4178, 643.63, 336.45},
                                {1.23, 1.06, 4183, 3557, 858.48, 387.98},
                                // ur10e
                                {0.61, 1.96, 3959, 12557, 866.78, 425.52},
                                {0.38, 0.34, 3519, 3032, 819.03, 396.06},
                                {0.67, 0.56, 2971, 2518, 802.66, 331.1},
                                {0.39, 0.45, 3044, 3375, 637.73, 341.34},
                                {1.39, 1.15, 4514, 3690, 855.76, 398.1},
                                // panda
                                {0.44, 0.34, 2793, 2088, 770.5, 385.64},
                                {0.36, 0.27, 3221, 2289, 757.46, 377.02},
                                {0.8, 0.71, 3276, 2888, 788.95, 346.76},
                                {0.35, 0.33, 2824, 2579, 565.99, 300.37},
                                {1.22, 0.9, 3931, 2872, 882.37, 412.89},
                                // sawyer
                                {0.45, 0.36, 3078, 2447, 834.94, 398.78},
                                {0.38, 0.32, 3549, 2891, 777.53, 373.37},
                                {0.78, 0.59, 3339, 2560, 755.48, 328.53},
                                {0.44, 0.39, 3693, 3221, 634.27, 329.8},
                                {1.19, 0.97, 4044, 3284, 949.92, 400.35},
                            }};

const PaperTable kNone;

}  // namespace

std::optional<PaperCell> PaperTable::find(std::string_view robot, std::string_view guidance) const {
  const auto column = std::ranges::find(robots, robot);
  const auto source = std::ranges::find(robots, guidance);
  if (column == robots.end() || (guidance != "uniform" && source == robots.end()))
    return std::nullopt;
  const auto row = guidance == "uniform" ? 0 : 1 + (source - robots.begin());
  const auto index = row * std::ssize(robots) + (column - robots.begin());
  return cells.at(static_cast<std::size_t>(index));
}

const PaperTable& paper_table(std::string_view study) {
  if (study == "planar")
    return kPlanar;
  return study == "cobots" ? kCobots : kNone;
}

}  // namespace kinship::experiments
