#include "services/common/mismatch/noise.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "sealwatch/signal/noise_floor.hpp"
#include "services/common/dense/dense.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr Eigen::Index kPiece = 64;
constexpr Eigen::Index kOrder = std::tuple_size_v<Covariances> - 1;
constexpr Eigen::Index kPolynomials = 8;           // taken off each piece
constexpr Eigen::Index kTwice = 2 * kPolynomials;  // to see whether that was enough
constexpr Eigen::Index kStraight = 3;              // of them, those that a steady motion fills as well
constexpr double kQuietShare = 0.25;
constexpr double kLeastCorrelation = 0.05;  // below it whitening would change no variance by more than 0.3 %
constexpr double kSignificant = 3.0;        // standard errors of a correlation

// Orthonormal polynomials of degree 0..15 over a piece: each made of the last one, so that none is lost to rounding.
const Eigen::MatrixXd& polynomials() {
  static const Eigen::MatrixXd matrix = [] {
    const Eigen::VectorXd place = Eigen::VectorXd::LinSpaced(kPiece, -1.0, 1.0);
    Eigen::MatrixXd columns = Eigen::MatrixXd::Ones(kPiece, kTwice);
    for (Eigen::Index k = 0; k < kTwice; ++k) {
      if (k > 0) columns.col(k) = place.cwiseProduct(columns.col(k - 1));
      for (Eigen::Index lower = 0; lower < k; ++lower)
        columns.col(k) -= columns.col(lower).dot(columns.col(k)) * columns.col(lower);
      columns.col(k).normalize();
    }
    return columns;
  }();
  return matrix;
}

// Takes the first of them off a piece.
Eigen::MatrixXd detrending_by(Eigen::Index count) {
  const Eigen::MatrixXd first = polynomials().leftCols(count);
  return Eigen::MatrixXd::Identity(kPiece, kPiece) - dense::product_transposed(first, first);
}

// The quietest pieces, detrended. What moves shows in the upper polynomials; what is left of a piece has no part in
// the choice, so that quiet noise is not preferred to loud noise.
std::vector<Eigen::VectorXd> quiet_pieces_of(const std::vector<double>& values, const Eigen::MatrixXd& detrending) {
  struct Piece {
    Eigen::VectorXd rest;
    double motion;
  };
  std::vector<Piece> pieces;
  for (std::size_t begin = 0; begin + kPiece <= values.size(); begin += kPiece) {
    const Eigen::Map<const Eigen::VectorXd> piece(values.data() + begin, kPiece);
    const auto moving = polynomials().middleCols(kStraight, kPolynomials - kStraight);
    pieces.push_back({detrending * piece, (moving.transpose() * piece).squaredNorm()});
  }
  std::ranges::stable_sort(pieces, {}, &Piece::motion);
  pieces.resize(static_cast<std::size_t>(std::ceil(kQuietShare * static_cast<double>(pieces.size()))));
  std::vector<Eigen::VectorXd> quiet;
  for (Piece& piece : pieces) quiet.push_back(std::move(piece.rest));
  return quiet;
}

void add_covariances(const std::vector<Eigen::VectorXd>& pieces, Covariances& sum, double& samples) {
  for (const Eigen::VectorXd& piece : pieces) {
    add_products(piece, sum);
    samples += static_cast<double>(kPiece);
  }
}

// Yule and Walker's equations for the correlations rho_1..rho_p.
ChannelColour autoregression(const Covariances& covariance) {
  Eigen::Matrix<double, kOrder, kOrder> matrix;
  Eigen::Matrix<double, kOrder, 1> right;
  for (Eigen::Index j = 0; j < kOrder; ++j) {
    right(j) = covariance[static_cast<std::size_t>(j + 1)] / covariance[0];
    for (Eigen::Index k = 0; k < kOrder; ++k)
      matrix(j, k) = covariance[static_cast<std::size_t>(std::abs(j - k))] / covariance[0];
  }
  const Eigen::Matrix<double, kOrder, 1> a = dense::Symmetric(matrix).solve(Eigen::VectorXd(right));
  return {.coefficients = {a.begin(), a.end()}, .innovation_std = std::sqrt(std::max(1e-6, 1.0 - a.dot(right)))};
}

// Mean products at each lag that detrended pieces of such noise would have: E r r' = M C M, C the noise's covariances.
Covariances after_detrending(const Covariances& covariance, const Eigen::MatrixXd& detrending) {
  const ChannelColour colour = autoregression(covariance);
  std::vector<double> all(static_cast<std::size_t>(kPiece), 0.0);
  for (std::size_t lag = 0; lag < all.size(); ++lag) {
    if (lag <= kOrder) all[lag] = covariance[lag];
    for (std::size_t k = 1; lag > kOrder && k <= kOrder; ++k) all[lag] += colour.coefficients[k - 1] * all[lag - k];
  }
  Eigen::MatrixXd c(kPiece, kPiece);
  for (Eigen::Index j = 0; j < kPiece; ++j)
    for (Eigen::Index k = 0; k < kPiece; ++k) c(j, k) = all[static_cast<std::size_t>(std::abs(j - k))];
  const Eigen::MatrixXd left = dense::product(dense::product(detrending, c), detrending);
  Covariances seen{};
  for (Eigen::Index lag = 0; lag <= kOrder; ++lag)
    seen[static_cast<std::size_t>(lag)] = left.diagonal(lag).sum() / static_cast<double>(kPiece - lag);
  return seen;
}

// The noise's covariances from those of the detrended pieces: polynomials take slow noise along and make white noise
// look correlated.
Covariances undo_detrending(const Covariances& seen, const Eigen::MatrixXd& detrending) {
  constexpr int kIterations = 30;
  Covariances covariance = seen;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Covariances now = after_detrending(covariance, detrending);
    for (std::size_t lag = 0; lag <= kOrder; ++lag) covariance[lag] += seen[lag] - now[lag];
    for (std::size_t lag = 1; lag <= kOrder; ++lag)
      covariance[lag] = std::clamp(covariance[lag], -0.98 * covariance[0], 0.98 * covariance[0]);
  }
  return covariance;
}

// Root mean square of the recordings' floors by differences: of one channel, over all recordings.
double pooled_floor(const Data& data, const std::string& channel) {
  double squares = 0.0, count = 0.0;
  for (const TimeSeries& recorded : data.samples)
    if (const Series* series = recorded.find(channel)) {
      squares += std::pow(signal::estimate_noise_floor(series->values, recorded.time_s).standard_deviation, 2);
      count += 1.0;
    }
  return std::sqrt(squares / std::max(count, 1.0));
}

bool are_alike(double one, double other) {
  constexpr double kAlike = 1.5;
  return one < kAlike * other && other < kAlike * one;
}

// Whether what the quiet pieces show is the noise of the rest as well: third differences of it are as large as those of
// all samples. A sensor that stands still, or a signal that pieces of this length cannot be freed of, is not it.
bool is_of_all_samples(const Covariances& covariance, double floor) {
  const double third_difference =
      20.0 * covariance[0] - 30.0 * covariance[1] + 12.0 * covariance[2] - 2.0 * covariance[3];
  const double ratio = std::sqrt(std::max(third_difference, 0.0) / 20.0) / floor;
  return are_alike(ratio, 1.0);
}

// The noise's covariances from the quiet pieces of all recordings, freed of so many polynomials; none of too few samples.
std::optional<Covariances> covariances_of(const Data& data, const std::string& channel, Eigen::Index count,
                                          double& samples) {
  const Eigen::MatrixXd detrending = detrending_by(count);
  Covariances covariance{};
  samples = 0.0;
  for (const TimeSeries& recorded : data.samples)
    if (const Series* series = recorded.find(channel))
      add_covariances(quiet_pieces_of(series->values, detrending), covariance, samples);
  if (!(covariance[0] > 0.0) || samples < 4.0 * kPiece) return std::nullopt;
  covariance = undo_detrending(covariance, detrending);
  for (double& one : covariance) one /= samples;
  return covariance;
}

// What twice as many polynomials take off as well is motion that the first do not follow: a kink, a fast stroke, a mass
// that rings. Of noise, whatever its colour, both tell the same.
bool shows_motion(const Covariances& covariance, const Covariances& by_twice) {
  return !are_alike(std::sqrt(covariance[0]), std::sqrt(by_twice[0]));
}

// Correlations rho_1..rho_3 of autoregressive noise: Yule and Walker's equations for them.
Covariances correlations_of(const ChannelColour& colour) {
  if (colour.coefficients.empty()) return {1.0};
  const double a1 = colour.coefficients[0], a2 = colour.coefficients[1], a3 = colour.coefficients[2];
  const double first = (a1 + a2 * a3) / (1.0 - a2 - a3 * (a1 + a3)), second = a2 + (a1 + a3) * first;
  return {1.0, first, second, a1 * second + a2 * first + a3};
}

// A channel's residuals in all recordings: products of those so many samples apart, over the noise's variance. Samples
// that do not count are none of them.
struct Rest {
  Covariances products{};
  double whitened = 0.0;  // sum of squares
  double samples = 0.0;
};
Rest rest_of(const FittedModel& model, Eigen::Index channel) {
  Rest rest;
  for (std::size_t k = 0; k < model.problem.recordings.size(); ++k) {
    const PemRecording& recording = model.problem.recordings[k];
    const Linearisation& at = model.optimum.at_optimum[k];
    if (channel >= at.simulated.cols() || !std::isfinite(recording.noise_std(channel))) continue;
    Eigen::VectorXd plain =
        (recording.simulation->recorded().col(channel) - at.simulated.col(channel)) / recording.noise_std(channel);
    double count = 0.0;
    for (Eigen::Index row = 0; const double weight : weights_of(recording, channel)) {
      if (weight == 0.0) plain(row) = 0.0;
      if (weight > 0.0) ++count;
      ++row;
    }
    add_products(plain, rest.products);
    rest.whitened += at.residual(Eigen::seqN(channel, at.simulated.rows(), at.simulated.cols())).squaredNorm();
    rest.samples += count;
  }
  return rest;
}

}  // namespace

void add_products(const Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>& values, Covariances& sum) {
  const Eigen::Index count = values.size();
  for (Eigen::Index lag = 0; lag <= std::min(kOrder, count - 1); ++lag)
    sum[static_cast<std::size_t>(lag)] += values.head(count - lag).dot(values.tail(count - lag)) *
                                          static_cast<double>(count) / static_cast<double>(count - lag);
}

std::pair<ChannelColour, double> sum_of_noise(const ChannelColour& sensor, double sensor_std, const Covariances& more) {
  Covariances covariance = correlations_of(sensor);
  for (std::size_t lag = 0; lag < covariance.size(); ++lag)
    covariance[lag] = sensor_std * sensor_std * covariance[lag] + more[lag];
  const bool white = std::abs(covariance[1]) < kLeastCorrelation * covariance[0];
  return {white ? ChannelColour{} : autoregression(covariance), std::sqrt(covariance[0])};
}

void find_noise(Data& data, const std::vector<std::string>& channels) {
  data.colour.assign(data.samples.size(), NoiseColour(channels.size()));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const double floor = pooled_floor(data, channels[c]);
    double samples = 0.0;
    const auto found = covariances_of(data, channels[c], kPolynomials, samples);
    const auto by_twice = covariances_of(data, channels[c], kTwice, samples);
    if (!found || !by_twice) continue;
    const Covariances& covariance = *found;
    if (!is_of_all_samples(covariance, floor) || shows_motion(covariance, *by_twice)) continue;
    const double correlation = covariance[1] / covariance[0];
    if (std::abs(correlation) < std::max(kLeastCorrelation, kSignificant / std::sqrt(samples))) continue;
    const ChannelColour colour = autoregression(covariance);
    // Differences do not see slow noise; how much louder one recording is than another they do.
    const double growth = std::sqrt(covariance[0]) / floor;
    for (std::size_t k = 0; k < data.samples.size(); ++k) {
      data.colour[k][c] = colour;
      for (Series& series : data.samples[k].channels)
        if (series.name == channels[c] && series.noise_std <= 0.0)
          series.noise_std =
              growth * signal::estimate_noise_floor(series.values, data.samples[k].time_s).standard_deviation;
    }
  }
}

std::vector<std::string> colours_in_words(const Data& data, const std::vector<std::string>& channels) {
  std::vector<std::string> sentences;
  for (std::size_t c = 0; c < channels.size(); ++c)
    if (const ChannelColour& colour = data.colour.front()[c]; !colour.coefficients.empty())
      sentences.push_back(text::format(
          "The noise of {} is correlated from sample to sample ({:.2f}); it was whitened by an autoregression.",
          text::in_words(channels[c]), correlations_of(colour)[1]));
  return sentences;
}

bool is_refuted(const ChannelColour& colour, double plain, double whitened) {
  if (colour.coefficients.empty() || plain > kAtTheNoise) return false;
  double most = 1.0;
  for (const double a : colour.coefficients) most += std::abs(a);
  const double gain = std::pow(most / colour.innovation_std, 2);
  return whitened - 1.0 > gain * (kAtTheNoise - 1.0);
}

bool take_colour_of_residuals(const FittedModel& model, Data& data) {
  bool taken = false;
  for (std::size_t c = 0; c < data.colour.front().size(); ++c) {
    const Rest rest = rest_of(model, static_cast<Eigen::Index>(c));
    if (rest.samples == 0.0) continue;
    if (!is_refuted(data.colour.front()[c], rest.products[0] / rest.samples, rest.whitened / rest.samples)) continue;
    const ChannelColour colour = sum_of_noise({}, 0.0, rest.products).first;
    for (NoiseColour& one : data.colour) one[c] = colour;
    taken = true;
  }
  return taken;
}

}  // namespace sealwatch::mismatch
