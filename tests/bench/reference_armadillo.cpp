// Armadillo's side of fit_bench: reference_armadillo FOLDER D K, prints CPU milliseconds per EM
// iteration from the start that fit_bench wrote.

#include <armadillo>
#include <ctime>
#include <fstream>
#include <iostream>
#include <string>

namespace {

double cpu_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void read(std::ifstream& file, double* values, arma::uword count) {
  file.read(reinterpret_cast<char*>(values), static_cast<std::streamsize>(count * sizeof(double)));
}

double fit_s(const arma::mat& points, const arma::gmm_full& start, arma::uword iterations) {
  arma::gmm_full model = start;
  const double begin = cpu_s();
  if (!model.learn(points, start.n_gaus(), arma::maha_dist, arma::keep_existing, 0, iterations,
                   1e-4, false))
    std::cerr << "armadillo: the fit failed\n";
  return cpu_s() - begin;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4)
    return 2;
  const std::string folder = argv[1], name_of_points = folder + "/points";
  const arma::uword d = std::stoul(argv[2]), k = std::stoul(argv[3]);
  std::ifstream points_file(name_of_points, std::ios::binary | std::ios::ate);
  const auto bytes = static_cast<arma::uword>(points_file.tellg());
  points_file.seekg(0);
  arma::mat points(d, bytes / sizeof(double) / d);
  read(points_file, points.memptr(), points.n_elem);
  std::ifstream start_file(folder + "/start", std::ios::binary);
  arma::rowvec weights(k);
  arma::mat means(d, k);
  arma::cube covariances(d, d, k);
  read(start_file, weights.memptr(), weights.n_elem);
  read(start_file, means.memptr(), means.n_elem);
  read(start_file, covariances.memptr(), covariances.n_elem);
  arma::gmm_full start;
  start.set_params(means, covariances, weights / arma::accu(weights));
  const double one = fit_s(points, start, 1);
  const double six = fit_s(points, start, 6);
  std::cout << 1000 * (six - one) / 5 << '\n';
  return 0;
}
