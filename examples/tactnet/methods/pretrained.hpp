#pragma once

// Networks that others have trained on photographs, which methods begin with: what a user gives by
// --pretrained, and what stays the same from training to training.

#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/shape.hpp>

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

struct image_data;

struct photograph_network {
    std::string_view name;        ///< in the names of methods: "squeezenet"
    std::string_view title;       ///< in sentences: "SqueezeNet 1.1"
    std::string_view torchvision; ///< what makes it there: "squeezenet1_1"
    tactnet::shape photograph;    ///< what it was trained on
};

namespace photograph_networks {

inline constexpr photograph_network squeezenet{
    "squeezenet", "SqueezeNet 1.1", "squeezenet1_1", {227, 227, 3}},
    alexnet{"alexnet", "AlexNet", "alexnet", {224, 224, 3}},
    resnet50{"resnet50", "ResNet-50", "resnet50", {224, 224, 3}},
    vgg16{"vgg16", "VGG16", "vgg16", {224, 224, 3}};

inline constexpr std::array all{squeezenet, alexnet, resnet50, vgg16};

} // namespace photograph_networks

/// The file that a method needs, for sentences.
struct pretrained_file {
    photograph_network network;
    std::string array; ///< one that must be in it: "features.0.weight"
    std::size_t bytes; ///< that its arrays take in single precision
};

/// Where features of images are kept.
struct feature_place {
    std::filesystem::path path;
    bool is_folder; ///< of files that are named by what is in them; else one file, by this name
};

/// Such a file, opened by a method and found to fit it.
class pretrained_weights {
public:
    virtual ~pretrained_weights() = default;
    /// Computes what all trainings on these images have in common, and keeps it in `place`, where another
    /// call goes on however this one was stopped. Returns false if it was interrupted. The images must
    /// outlive this.
    virtual bool prepare(const image_data&, const feature_place&, tactnet::thread_pool&) { return true; }
};
