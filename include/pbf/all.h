/* pbf/all.h: all that a program calls, for tools that read declarations from one file. */
#ifndef PBF_ALL_H
#define PBF_ALL_H

#include <pbf/batch.h>
#include <pbf/diffuse.h>
#include <pbf/emit.h>
#include <pbf/pbf.h>
#include <pbf/phases.h>
#include <pbf/query.h>
#include <pbf/shapes.h>

#endif
