#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/operators/lowering.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/tensor/tensor.hpp>
#include <tactnet/tensor/tensor_view.hpp>
#include <tactnet/text/message.hpp>
#include <tactnet/transfer/as_photograph.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

// From the last feature map of a pretrained network to a row of features.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Which values of a feature map become features.
enum class feature_pooling {
    none,    ///< every value, as in the paper
    maximum, ///< the largest of each channel
    average  ///< the mean of each channel
};

/// The number of features of a map.
[[nodiscard]] constexpr std::size_t feature_count(feature_pooling pooling, shape map) {
    return pooling == feature_pooling::none ? map.size() : map.channels;
}

/// `map` is ordered [channel][row][column]; `to` holds feature_count(pooling, extents) numbers.
inline void pool_features(feature_pooling pooling, std::span<const float> map, shape extents,
                          std::span<float> to) {
    if (pooling == feature_pooling::none) {
        std::copy(map.begin(), map.end(), to.begin());
        return;
    }
    for (std::size_t channel = 0; channel < extents.channels; ++channel) {
        const auto plane = map.subspan(channel * extents.area(), extents.area());
        if (pooling == feature_pooling::maximum) {
            to[channel] = *std::max_element(plane.begin(), plane.end());
        } else {
            double sum = 0;
            for (const float value : plane)
                sum += static_cast<double>(value);
            to[channel] = static_cast<float>(sum / static_cast<double>(plane.size()));
        }
    }
}

/// Computes features of pressure images with the first layers of a network that was trained on photographs,
/// for a support vector machine or a trained head. `Trunk` is a network of three input channels, `Grey` the
/// shape of the images. Any number of threads may call const members; rows are bit-identical on any number of
/// them.
template <class Trunk, shape Grey>
class feature_extractor {
    using trunk_type = deployed<Trunk>;
    static constexpr shape photograph = Trunk::input_shape;

public:
    /// The shape of the trunk's last feature map.
    static constexpr shape map = trunk_type::view_type::output_shape;

    /// Copies the weights of a trained trunk. Throws as `deploy` does.
    feature_extractor(const Trunk& trunk, const photograph_preprocessing& form,
                      feature_pooling pooling = feature_pooling::none)
        : trunk_(deploy(trunk)), form_(form), pooling_(pooling) {}

    /// The number of features of one image.
    [[nodiscard]] std::size_t features() const { return feature_count(pooling_, map); }

    /// Returns a row of features per chosen image. Images are 8-bit counts, ordered [image][row][column].
    /// Throws std::invalid_argument for an incomplete image and for a chosen index beyond the last, and
    /// std::runtime_error if a feature is not finite.
    [[nodiscard]] std::vector<float> rows(std::span<const std::uint8_t> images,
                                          std::span<const std::size_t> chosen, thread_pool& threads) const {
        check(images, chosen);
        std::vector<float> result(chosen.size() * features());
        threads.on_each_thread([&](thread_pool::share part) {
            const std::unique_ptr<memory> own(new memory); // not zeroed
            for (std::size_t i = part.begin(chosen.size()); i < part.end(chosen.size()); ++i)
                extract(images.subspan(chosen[i] * Grey.size()).template first<Grey.size()>(), chosen[i],
                        *own, std::span(result).subspan(i * features(), features()));
        });
        return result;
    }

private:
    /// Buffers of one thread; too large for the stack.
    struct memory {
        tensor<float, photograph> picture;
        tensor<float, map> last;
        typename trunk_type::workspace workspace;
    };

    static void check(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen) {
        const std::size_t count = images.size() / Grey.size();
        if (count * Grey.size() != images.size())
            detail::throw_invalid_argument({"feature_extractor: expected images of ", Grey.size(),
                                            " counts, found ", images.size(), " counts"});
        for (const std::size_t image : chosen)
            if (image >= count)
                detail::throw_invalid_argument(
                    {"feature_extractor: expected an image among ", count, ", found ", image});
    }
    void extract(std::span<const std::uint8_t, Grey.size()> image, std::size_t index, memory& own,
                 std::span<float> to) const {
        to_photograph(tensor_view<const std::uint8_t, Grey>(image), form_, own.picture.view());
        const tensor_view<const float, photograph> picture(own.picture.view());
        if (trunk_.infer(picture, own.last.view().elements(), own.workspace) != frame_status::ok)
            throw std::runtime_error("feature_extractor: expected finite features of image " +
                                     std::to_string(index) + ", found some that are not");
        pool_features(pooling_, own.last.view().elements(), map, to);
    }

    trunk_type trunk_;
    photograph_preprocessing form_;
    feature_pooling pooling_;
};

}} // namespace tactnet
