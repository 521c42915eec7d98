#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/tensor.hpp>
#include <tactnet/tensor/tensor_view.hpp>
#include <tactnet/transfer/feature_pooling.hpp>
#include <tactnet/transfer/photograph.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Pressure images through the first layers of a network that was trained on photographs: features for a
/// support vector machine, or for layers that are trained on top. `Trunk` is a network of three input
/// channels, `Grey` the shape of the images. Const calls may come from any number of threads, and a row is
/// bit-exact on any number of them.
template <class Trunk, shape Grey>
class feature_extractor {
    using trunk_type = deployed<Trunk>;
    static constexpr shape photograph = Trunk::input_shape;

public:
    static constexpr shape image_shape = Grey;
    /// What the trunk ends in.
    static constexpr shape map = trunk_type::view_type::output_shape;

    /// Takes the weights of a trained trunk. Throws as `deploy`.
    feature_extractor(const Trunk& trunk, const photograph_form& form,
                      feature_pooling pooling = feature_pooling::none)
        : trunk_(deploy(trunk)), form_(form), pooling_(pooling) {}

    /// Numbers of one image.
    [[nodiscard]] std::size_t features() const { return feature_count(pooling_, map); }

    /// A row of features for each of the chosen images, which are stored one after the other: [row][column],
    /// counts of 8 bits. Throws std::invalid_argument unless all images are whole and each chosen one is
    /// among them, and std::runtime_error when a feature is not finite, which finite weights of a usual size
    /// do not give.
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
    /// Of one image on its way. Too large for the stack.
    struct memory {
        tensor<float, photograph> picture;
        tensor<float, map> last;
        typename trunk_type::workspace workspace;
    };

    static void check(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen) {
        const std::size_t count = images.size() / Grey.size();
        if (count * Grey.size() != images.size())
            throw std::invalid_argument("feature_extractor: expected images of " +
                                        std::to_string(Grey.size()) + " counts, found " +
                                        std::to_string(images.size()) + " counts");
        for (const std::size_t image : chosen)
            if (image >= count)
                throw std::invalid_argument("feature_extractor: expected an image among " +
                                            std::to_string(count) + ", found " + std::to_string(image));
    }
    void extract(std::span<const std::uint8_t, Grey.size()> image, std::size_t index, memory& own,
                 std::span<float> to) const {
        to_photograph(tensor_view<const std::uint8_t, Grey>(image), form_, own.picture.view());
        const tensor_view<const float, photograph> picture(own.picture.view());
        if (trunk_(picture, own.last.view().elements(), own.workspace) != frame_status::ok)
            throw std::runtime_error("feature_extractor: expected finite features of image " +
                                     std::to_string(index) + ", found some that are not");
        pool_features(pooling_, own.last.view().elements(), map, to);
    }

    trunk_type trunk_;
    photograph_form form_;
    feature_pooling pooling_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
