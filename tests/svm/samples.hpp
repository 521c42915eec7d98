#pragma once

#include <tactnet/runtime/random.hpp>
#include <tactnet/svm/feature_rows.hpp>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>
#include <vector>

// Synthetic samples for the tests of machines.

namespace support {

struct samples {
    std::size_t features = 0;
    std::vector<float> values;
    std::vector<std::size_t> labels;

    [[nodiscard]] tactnet::feature_rows<> rows() const { return {values, features}; }
};

/// Normal clouds around random centres, classes in turn; `spread` 1 is as wide as the centres are apart.
inline samples blobs(std::size_t count, std::size_t features, std::size_t classes, double spread,
                     std::uint64_t seed = 1) {
    tactnet::random_stream random(seed, tactnet::random_purposes::order);
    samples s{features, {}, {}};
    std::vector<double> centres(classes * features);
    for (double& value : centres)
        value = random.uniform(-1, 1);
    for (std::size_t i = 0; i < count; ++i) {
        s.labels.push_back(i % classes);
        for (std::size_t f = 0; f < features; ++f)
            s.values.push_back(
                static_cast<float>(centres[i % classes * features + f] + spread * random.normal()));
    }
    return s;
}

/// What a call throws, as text; empty if nothing.
template <class Body>
std::string error_of(const Body& body) {
    try {
        body();
    } catch (const std::exception& error) {
        return error.what();
    }
    return {};
}

} // namespace support
