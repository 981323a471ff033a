#pragma once

// What the examples of headers take for granted.

#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include "data/authoring/sheet.h"
#include "data/body/body.h"
#include "data/core/paths.h"
#include "gnn/model/engine.h"
#include "gnn/model/make_cloth.h"
#include "render/osmesa_renderer.h"
#include "render/renderer.h"

namespace cloth {

extern const Garment garment;
extern Boundary boundary;
extern ClothState state;
extern const double dt;
extern const int threads;
extern const Eigen::Index i;

}  // namespace cloth
