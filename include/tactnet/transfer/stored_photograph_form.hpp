#pragma once

#include <tactnet/io/stored_arrays.hpp>
#include <tactnet/transfer/photograph.hpp>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What the weights in a file were trained with: counts less the mean of each channel where the file has an
/// array `input_mean` of three numbers (behind `prefix`), else torchvision's normalisation. `File` is a
/// safetensors_source or safetensors. Throws file_error for an array of another size, and for numbers
/// that are not finite.
template <class File>
[[nodiscard]] photograph_form stored_photograph_form(File& file, const std::string& prefix = "") {
    const std::string name = prefix + "input_mean";
    if (!file.contains(name))
        return torchvision_photograph;
    file.require_extents(name, std::array<std::size_t, 1>{3});
    const std::vector<float> mean = file.template values<float>(name);
    detail::check_values(file, name, mean);
    return mean_photograph(mean[0], mean[1], mean[2]);
}

} // namespace TACTNET_ARCH
} // namespace tactnet
