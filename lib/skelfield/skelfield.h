/* SPDX-License-Identifier: MIT */
/* skelfield: fields of skeletal bodies. This header includes the whole public interface. */
#ifndef SKELFIELD_H
#define SKELFIELD_H

#include "skelfield/core.h"
#include "skelfield/skeleton.h"
#include "skelfield/polygon.h"
#include "skelfield/field.h"
#include "skelfield/handles.h"
#include "skelfield/ray.h"
#include "skelfield/render.h"
#include "skelfield/motion.h"
#include "skelfield/rigid.h"
#include "skelfield/surface.h"
#include "skelfield/scene.h"

#endif
