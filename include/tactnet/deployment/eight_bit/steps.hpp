#pragma once

#include <tactnet/deployment/eight_bit/frame.hpp>
#include <tactnet/deployment/eight_bit/steps/convolution.hpp>
#include <tactnet/deployment/eight_bit/steps/elementwise.hpp>
#include <tactnet/deployment/eight_bit/steps/pooling.hpp>
#include <tactnet/deployment/steps.hpp>
