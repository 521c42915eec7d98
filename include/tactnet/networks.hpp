#pragma once

#include <tactnet/networks/imagenet/alexnet.hpp>
#include <tactnet/networks/imagenet/resnet.hpp>
#include <tactnet/networks/imagenet/squeezenet.hpp>
#include <tactnet/networks/imagenet/vgg16.hpp>
#include <tactnet/networks/model.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/networks/normalisation.hpp>
#include <tactnet/networks/published.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/networks/symmetric_window.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>
