#pragma once

#include <tactnet/runtime/random.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Which part each sample is in when they are divided for cross-validation: classes are drawn apart, and
/// dealt out in turn, so that each part has about as many of each.
[[nodiscard]] inline std::vector<std::size_t>
deal_folds(const std::vector<std::vector<std::size_t>>& samples_of_classes, std::size_t samples,
           std::size_t folds, std::uint64_t seed) {
    std::vector<std::size_t> fold_of(samples);
    std::size_t next = 0;
    for (std::size_t c = 0; c < samples_of_classes.size(); ++c) {
        std::vector<std::size_t> members = samples_of_classes[c];
        random_stream(seed, random_purposes::split, static_cast<std::uint32_t>(c)).shuffle(members);
        for (const std::size_t sample : members)
            fold_of[sample] = next++ % folds;
    }
    return fold_of;
}

} // namespace TACTNET_ARCH
} // namespace tactnet
