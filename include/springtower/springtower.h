#pragma once

/// All of the public interface.
#include <springtower/inputs.h>
#include <springtower/query.h>
#include <springtower/scene.h>
#include <springtower/settings.h>
#include <springtower/statics.h>
#include <springtower/world.h>
