#pragma once

#include <tactnet/image/augmentation.hpp>
#include <tactnet/image/resize.hpp>
#include <tactnet/image/three_channels.hpp>
#include <tactnet/image/transform.hpp>
