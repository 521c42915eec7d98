#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>
#include <string>
#include <vector>

// One description of a named array, for the parameters of networks, the arrays of weight files, and the
// folded numbers of deployed networks. It needs no network type, so what works with it compiles once per
// unit.

namespace tactnet { inline namespace TACTNET_ARCH {

/// An array of a network or of its file, by PyTorch's name.
struct named_array {
    std::string name;                 ///< for example "conv1.weight"
    std::vector<std::size_t> extents; ///< for example {filters, channels, rows, columns}
    /// The input of a fully connected layer, [channels, rows, columns], which its weights join to one extent.
    /// Files may store the weights with either extents. Empty for other arrays.
    std::vector<std::size_t> flattened = {};
    std::size_t offset = 0; ///< of the first element, among the elements that it is stored with
    std::size_t size = 0;   ///< number of elements, the product of the extents
};

/// The names joined by a point, as PyTorch joins them; an empty one adds nothing.
[[nodiscard]] [[gnu::cold, gnu::noinline]] inline std::string joined_name(const std::string& outer,
                                                                          const std::string& inner) {
    // Appending compiles less than adding: operator+ has five forms.
    std::string name(outer);
    if (!outer.empty() && !inner.empty())
        name.append(".", 1);
    return name.append(inner.data(), inner.size());
}

namespace detail {

/// The product of the extents; 1 for none.
[[nodiscard]] constexpr std::size_t product_of(const std::vector<std::size_t>& extents) {
    std::size_t product = 1;
    for (const std::size_t extent : extents)
        product *= extent;
    return product;
}

} // namespace detail

}} // namespace tactnet
