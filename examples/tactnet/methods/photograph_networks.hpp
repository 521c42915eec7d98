#pragma once

// Networks that others have trained on photographs, as they are called here and elsewhere: trunks of features
// and networks that are trained on are made of the same.

#include <tactnet/tensor/shape.hpp>

#include <array>
#include <string_view>

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
