#pragma once

#include <tactnet/networks/model.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/networks/published.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/networks/reflection_rule.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>
