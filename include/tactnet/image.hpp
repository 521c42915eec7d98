#pragma once

#include <tactnet/image/augmentation.hpp>
#include <tactnet/image/dynamic_resize.hpp>
#include <tactnet/image/noise.hpp>
#include <tactnet/image/resize.hpp>
#include <tactnet/image/three_channels.hpp>
#include <tactnet/image/transform.hpp>
