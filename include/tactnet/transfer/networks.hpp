#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/io/stored_arrays.hpp>
#include <tactnet/networks/imagenet.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/networks/published.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/operators/lowering.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/tensor/tensor.hpp>
#include <tactnet/text/message.hpp>
#include <tactnet/transfer/as_photograph.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
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

// The paper's ImageNet networks for transfer learning (TL-NN): pretrained on photographs, fine-tuned on
// pressure images of one channel, with a new last layer. The training settings are those of the authors'
// programs.

namespace detail {

template <shape Touch, class Network>
struct with_photograph_input;
template <shape Touch, class T, shape Photograph, class... Specs>
struct with_photograph_input<Touch, basic_network<T, Photograph, Specs...>> {
    using type =
        basic_network<T, Touch, as_photograph<extent2d{Photograph.rows, Photograph.columns}>, Specs...>;
};

} // namespace detail

/// Puts as_photograph before a network for photographs, so that it takes pressure images.
template <shape Touch, class Network>
using with_photograph_input = typename detail::with_photograph_input<Touch, Network>::type;

/// SqueezeNet 1.1 for touches.
template <shape Touch, std::size_t Classes>
using squeezenet_nn = with_photograph_input<Touch, squeezenet1_1<shape{227, 227, 3}, Classes>>;
/// AlexNet for touches.
template <shape Touch, std::size_t Classes>
using alexnet_nn = with_photograph_input<Touch, alexnet<shape{224, 224, 3}, Classes>>;
/// ResNet-50 for touches.
template <shape Touch, std::size_t Classes>
using resnet50_nn = with_photograph_input<Touch, resnet50<shape{224, 224, 3}, Classes>>;
/// VGG16 for touches.
template <shape Touch, std::size_t Classes>
using vgg16_nn = with_photograph_input<Touch, vgg16<shape{224, 224, 3}, Classes>>;

/// How the authors trained SqueezeNet, for images of any size. The rate is that of the last layer; the other
/// layers learn at the rate divided by `new_layer_factor`.
[[nodiscard]] constexpr published_training squeezenet_nn_training(shape) {
    return {.rate = 1e-3,
            .drop_period = 0,
            .patience = 0,
            .transfer = published_transfer{.epochs = 15, .batch = 64, .new_layer_factor = 1}};
}
/// How the authors trained AlexNet.
[[nodiscard]] constexpr published_training alexnet_nn_training(shape) {
    return {.rate = 2e-3,
            .drop_period = 0,
            .patience = 0,
            .transfer = published_transfer{.epochs = 10, .batch = 5, .new_layer_factor = 20}};
}
/// How the authors trained ResNet-50.
[[nodiscard]] constexpr published_training resnet50_nn_training(shape) {
    return {.rate = 1e-3,
            .drop_period = 0,
            .patience = 4,
            .transfer = published_transfer{.epochs = 10, .batch = 16, .new_layer_factor = 1}};
}
/// How the authors trained VGG16.
[[nodiscard]] constexpr published_training vgg16_nn_training(shape) {
    return {.rate = 2e-3,
            .drop_period = 0,
            .patience = 0,
            .transfer = published_transfer{.epochs = 10, .batch = 32, .new_layer_factor = 20}};
}

/// Reads the preprocessing that the weights of a file were trained with: if the file has an array
/// `input_mean` of three numbers (after `prefix`), these are subtracted from the counts; otherwise it is
/// torchvision's. `File` is a safetensors_source or safetensors. Throws file_error for an array of another
/// size, and for numbers that are not finite.
template <class File>
[[nodiscard]] photograph_preprocessing stored_photograph_preprocessing(File& file,
                                                                       const std::string& prefix = "") {
    const std::string name = prefix + "input_mean";
    if (!file.contains(name))
        return torchvision_photograph;
    file.require_extents(name, std::array<std::size_t, 1>{3});
    const std::vector<float> mean = file.template values<float>(name);
    detail::check_values(file, name, mean);
    return mean_photograph(mean[0], mean[1], mean[2]);
}

/// Reads the initial values for fine-tuning a pretrained network: the values of each array of a network that
/// begins with as_photograph, in its order, and none for the last layer, which learns other classes. `form`
/// gives the mean and variance of the photograph, for inputs of 0 … 1.
///
/// Throws one file_error that counts all arrays, and lists the first, that are missing, surplus or of other
/// extents, and file_error for values that are not finite; std::invalid_argument for a network without
/// as_photograph or without a last layer of its own.
[[nodiscard]] inline std::vector<std::vector<float>> pretrained_trunk(safetensors_source& file,
                                                                      const stored_arrays& arrays,
                                                                      const photograph_preprocessing& form) {
    const std::string last(arrays.output_layer());
    if (last.empty() || arrays.list.size() < 4 || arrays.list[0].name != "photograph.running_mean")
        throw std::invalid_argument(
            "pretrained_trunk: expected a network with as_photograph in front and a layer "
            "at its end with a filter for each class");
    stored_arrays trunk;
    for (const named_array& each : arrays.list)
        if (!each.name.starts_with(last) && !each.name.starts_with("photograph."))
            trunk.list.push_back(each);
    // The last layer is not read: its classes may be others.
    const std::array<std::string, 1> unread{last};
    require_arrays(file, trunk, 0, unread);
    std::vector<std::vector<float>> values;
    std::vector<float> mean, variance;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const float deviation = 1 / (form.normalise.scale[channel] * 255);
        mean.push_back(form.normalise.mean[channel] / 255);
        variance.push_back(deviation * deviation);
    }
    values.push_back(std::move(mean));
    values.push_back(std::move(variance));
    for (std::size_t i = 2; i < arrays.list.size(); ++i) {
        const std::string& name = arrays.list[i].name;
        if (name.starts_with(last)) {
            values.emplace_back();
            continue;
        }
        values.push_back(file.values<float>(name));
        detail::check_values(file, name, values.back());
    }
    return values;
}

}} // namespace tactnet
