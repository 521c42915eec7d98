#pragma once

#include <tactnet/decision/discriminant.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// Linear discriminant analysis with a shrunken covariance (Fisher, 1936; Friedman, 1989).

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Replaces the lower triangle of a positive definite matrix of `n` rows by its Cholesky factor.
inline void factorise(std::vector<double>& matrix, std::size_t n) {
    for (std::size_t column = 0; column < n; ++column)
        for (std::size_t row = column; row < n; ++row) {
            double sum = matrix[row * n + column];
            for (std::size_t k = 0; k < column; ++k)
                sum -= matrix[row * n + k] * matrix[column * n + k];
            matrix[row * n + column] = row == column ? std::sqrt(sum) : sum / matrix[column * n + column];
        }
}
/// Solves L x = b in place, for the factor L.
inline void solve_lower(const std::vector<double>& factor, std::size_t n, std::span<double> b) {
    for (std::size_t row = 0; row < n; ++row) {
        for (std::size_t k = 0; k < row; ++k)
            b[row] -= factor[row * n + k] * b[k];
        b[row] /= factor[row * n + row];
    }
}
/// Solves Lᵀ x = b in place.
inline void solve_upper(const std::vector<double>& factor, std::size_t n, std::span<double> b) {
    for (std::size_t row = n; row-- > 0;) {
        for (std::size_t k = row + 1; k < n; ++k)
            b[row] -= factor[k * n + row] * b[k];
        b[row] /= factor[row * n + row];
    }
}

/// Eigenvectors of a symmetric matrix of `n` rows, as columns, and eigenvalues, by Jacobi's rotations.
struct eigensystem {
    std::vector<double> values, vectors;
};
[[nodiscard]] inline eigensystem diagonalise(std::vector<double> matrix, std::size_t n) {
    eigensystem found{std::vector<double>(n), std::vector<double>(n * n)};
    for (std::size_t i = 0; i < n; ++i)
        found.vectors[i * n + i] = 1;
    for (int sweep = 0; sweep < 30; ++sweep)
        for (std::size_t p = 0; p < n; ++p)
            for (std::size_t q = p + 1; q < n; ++q) {
                const double off = matrix[p * n + q];
                if (off == 0)
                    continue;
                const double theta = (matrix[q * n + q] - matrix[p * n + p]) / (2 * off);
                const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::hypot(theta, 1.0));
                const double cosine = 1 / std::hypot(t, 1.0), sine = t * cosine;
                const auto rotate = [&](double& a, double& b) {
                    const double old = a;
                    a = cosine * old - sine * b;
                    b = sine * old + cosine * b;
                };
                for (std::size_t k = 0; k < n; ++k)
                    rotate(matrix[k * n + p], matrix[k * n + q]);
                for (std::size_t k = 0; k < n; ++k)
                    rotate(matrix[p * n + k], matrix[q * n + k]);
                for (std::size_t k = 0; k < n; ++k)
                    rotate(found.vectors[k * n + p], found.vectors[k * n + q]);
            }
    for (std::size_t i = 0; i < n; ++i)
        found.values[i] = matrix[i * n + i];
    return found;
}

/// Throws std::invalid_argument for a map of which a number overflows or is none.
template <class Number>
void require_finite(const char* caller, std::span<const Number> numbers) {
    for (const Number number : numbers)
        if (!std::isfinite(number))
            throw std::invalid_argument(
                std::string(caller) + ": expected features and a shrinkage that give a finite map, found " +
                std::to_string(number) + " in it: scale the features, or shrink more");
}

/// The means of classes, the mean of all, and the Cholesky factor of the covariance within classes.
struct class_scatter {
    std::vector<double> means, whole, factor;
};
/// See fit_discriminant. `caller` begins the messages of errors.
inline class_scatter scatter_of(const std::string& caller, std::size_t size, std::span<const float> features,
                                std::span<const std::size_t> labels, std::size_t classes, double shrinkage) {
    const auto refuse = [&](const std::string& expected, const std::string& found) {
        throw std::invalid_argument(caller + ": expected " + expected + ", found " + found);
    };
    const std::size_t images = labels.size();
    if (features.size() != images * size)
        refuse("a row of " + std::to_string(size) + " features for each of " + std::to_string(images) +
                   " labels",
               std::to_string(features.size()) + " features");
    if (!(shrinkage > 0 && shrinkage <= 1))
        refuse("a shrinkage above 0 and at most 1", std::to_string(shrinkage));
    std::vector<double> means(classes * size), whole(size);
    std::vector<std::size_t> counts(classes);
    for (std::size_t i = 0; i < images; ++i) {
        if (labels[i] >= classes)
            refuse("labels below " + std::to_string(classes), std::to_string(labels[i]));
        ++counts[labels[i]];
        for (std::size_t f = 0; f < size; ++f) {
            const float value = features[i * size + f];
            if (!(std::abs(value) <= std::numeric_limits<float>::max()))
                refuse("finite features", "others for image " + std::to_string(i));
            means[labels[i] * size + f] += static_cast<double>(value);
            whole[f] += static_cast<double>(value) / static_cast<double>(images);
        }
    }
    for (std::size_t c = 0; c < classes; ++c) {
        if (counts[c] == 0)
            refuse("an image of each class", "none of class " + std::to_string(c));
        for (std::size_t f = 0; f < size; ++f)
            means[c * size + f] /= static_cast<double>(counts[c]);
    }
    // The covariance within classes, towards its mean variance in all directions.
    std::vector<double> covariance(size * size), residual(size);
    for (std::size_t i = 0; i < images; ++i) {
        for (std::size_t f = 0; f < size; ++f)
            residual[f] = static_cast<double>(features[i * size + f]) - means[labels[i] * size + f];
        for (std::size_t f = 0; f < size; ++f)
            for (std::size_t g = 0; g <= f; ++g)
                covariance[f * size + g] += residual[f] * residual[g];
    }
    double trace = 0;
    for (std::size_t f = 0; f < size; ++f)
        trace += covariance[f * size + f];
    if (!(trace > 0))
        refuse("features that vary within classes", "none that do");
    for (double& value : covariance)
        value *= (1 - shrinkage) / static_cast<double>(images);
    for (std::size_t f = 0; f < size; ++f)
        covariance[f * size + f] += shrinkage * trace / static_cast<double>(images * size);
    factorise(covariance, size);
    return {std::move(means), std::move(whole), std::move(covariance)};
}

} // namespace detail

/// Fits a discriminant to the features of training images: a row of Features per image, with the labels of
/// their classes. In its dimensions the covariance within classes is about the unit matrix, and the means of
/// classes are as far apart as they can be. `shrinkage`, from above 0 to 1, is the share of a multiple of the
/// unit matrix in the covariance; it makes up for few images. There are at most classes − 1 dimensions of
/// use.
///
/// Throws std::invalid_argument unless each image has a row of finite features and a label below `classes`,
/// each class has an image, there are more classes than Dimensions, features vary within classes, and the map
/// is finite in single precision: features below 1e-30 or a tiny shrinkage may give none.
template <std::size_t Features, std::size_t Dimensions>
[[nodiscard]] std::unique_ptr<discriminant<Features, Dimensions>>
fit_discriminant(std::span<const float> features, std::span<const std::size_t> labels, std::size_t classes,
                 double shrinkage = 0.5) {
    if (classes <= Dimensions)
        throw std::invalid_argument("fit_discriminant: expected more than " + std::to_string(Dimensions) +
                                    " classes, found " + std::to_string(classes));
    auto [means, whole, covariance] =
        detail::scatter_of("fit_discriminant", Features, features, labels, classes, shrinkage);

    // The means of classes where that covariance is the unit matrix, and the directions in which they lie
    // apart.
    for (std::size_t c = 0; c < classes; ++c) {
        const auto mean = std::span(means).subspan(c * Features, Features);
        for (std::size_t f = 0; f < Features; ++f)
            mean[f] -= whole[f];
        detail::solve_lower(covariance, Features, mean);
    }
    std::vector<double> products(classes * classes);
    for (std::size_t a = 0; a < classes; ++a)
        for (std::size_t b = 0; b < classes; ++b)
            for (std::size_t f = 0; f < Features; ++f)
                products[a * classes + b] += means[a * Features + f] * means[b * Features + f];
    detail::require_finite<double>("fit_discriminant", products);
    const detail::eigensystem apart = detail::diagonalise(std::move(products), classes);
    std::vector<std::size_t> order(classes);
    for (std::size_t c = 0; c < classes; ++c)
        order[c] = c;
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return apart.values[a] > apart.values[b]; });

    auto result = std::make_unique<discriminant<Features, Dimensions>>();
    std::vector<double> direction(Features);
    for (std::size_t d = 0; d < Dimensions; ++d) {
        const double length = std::sqrt(std::max(apart.values[order[d]], 0.0));
        if (!(length > 1e-9 * std::sqrt(apart.values[order[0]])))
            continue; // fewer classes lie apart than there are dimensions
        std::fill(direction.begin(), direction.end(), 0.0);
        for (std::size_t c = 0; c < classes; ++c)
            for (std::size_t f = 0; f < Features; ++f)
                direction[f] += apart.vectors[c * classes + order[d]] / length * means[c * Features + f];
        detail::solve_upper(covariance, Features, direction);
        double offset = 0;
        for (std::size_t f = 0; f < Features; ++f) {
            result->directions[f * Dimensions + d] = static_cast<float>(direction[f]);
            offset -= direction[f] * whole[f];
        }
        result->offset[d] = static_cast<float>(offset);
    }
    detail::require_finite<float>("fit_discriminant", result->directions);
    detail::require_finite<float>("fit_discriminant", result->offset);
    return result;
}

}} // namespace tactnet
