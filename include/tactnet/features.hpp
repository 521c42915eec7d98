#pragma once

#include <tactnet/features/bag_of_words.hpp>
#include <tactnet/features/dense_surf.hpp>
#include <tactnet/features/integral_image.hpp>
#include <tactnet/features/k_means.hpp>
