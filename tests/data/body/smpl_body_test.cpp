#include "data/body/smpl_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "collision/proximity/metrics.h"
#include "data/body/body.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/garment_assets.h"
#include "gnn/model/make_cloth.h"
#include "tests/data/body/smpl_files.h"

namespace cloth::smpl_body_test {

using namespace cloth::test;

namespace {

using Arrays = std::map<std::string, std::string>;

std::string path_of(const char* name) {
    return testing::TempDir() + name;
}

SmplModel model_of(const Arrays& arrays) {
    const std::string path = path_of("model.npz");
    write_npz(path, arrays);
    return SmplModel::load(path);
}

AmassMotion motion_of(const Arrays& arrays) {
    const std::string path = path_of("motion.npz");
    write_npz(path, arrays);
    return AmassMotion::load(path);
}

TEST(SmplModel, HasWhatTheFileHas) {
    const SmplModel model = model_of(small_smpl_model());
    EXPECT_EQ(model.mean.rows(), 16);
    EXPECT_EQ(model.faces->rows(), 24);
    EXPECT_EQ(model.parents, (std::vector<int>{-1, 0, 1}));
    EXPECT_EQ(model.beta_count(), 2);
    EXPECT_EQ(model.weights->at(13, 2), 1.0);
    const Points joints = model.joints(model.rest({}));
    EXPECT_LT((joints - Points{{0, 0, 0}, {0, 1, 0}, {0, 2, 0}}).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(SmplModel, BetasMoveSkinAndJoints) {
    const SmplModel model = model_of(small_smpl_model());
    const Points rest = model.rest(Eigen::Vector2d(2.0, -1.0));
    for (int i = 0; i < 16; ++i) {
        const double ring = i / 4;
        EXPECT_LT(
            (rest.row(i) - model.mean.row(i) - Eigen::RowVector3d(-0.05, 0.2 * ring, 0)).norm(),
            1e-6);
    }
    EXPECT_LT((model.joints(rest).row(2) - Eigen::RowVector3d(-0.05, 2.4, 0)).norm(), 1e-6);
    EXPECT_THROW(model.rest(VectorX::Zero(3)), ArgumentError);
}

TEST(SmplModel, SparseAndDenseRegressorsAreTheSame) {
    Arrays arrays = small_smpl_model();
    arrays.erase("J_regressor");
    arrays["J_regressor_data"] = npy({12}, std::vector<float>(12, 0.25f));
    arrays["J_regressor_indices"] =
        npy({12}, std::vector<std::int32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
    arrays["J_regressor_indptr"] = npy({4}, std::vector<std::int32_t>{0, 4, 8, 12});
    EXPECT_EQ(model_of(arrays).regressor, model_of(small_smpl_model()).regressor);
}

TEST(SmplModel, BrokenFilesAreRefusedByFileAndArray) {
    const auto refusal = [](const char* array, const std::string& bytes) {
        Arrays arrays = small_smpl_model();
        arrays.erase(array);
        if (!bytes.empty()) arrays[array] = bytes;
        try {
            model_of(arrays);
        } catch (const LoadError& error) {
            const std::string text = error.what();
            return text.find(std::string("array ") + array) != std::string::npos &&
                   text.find("model.npz") != std::string::npos;
        }
        return false;
    };
    for (const char* array : {"v_template", "f", "weights", "kintree_table", "J_regressor"})
        EXPECT_TRUE(refusal(array, "")) << array;
    EXPECT_TRUE(refusal("f", npy({1, 3}, std::vector<std::uint32_t>{0, 1, 16})));
    EXPECT_TRUE(refusal("f", npy({1, 3}, std::vector<double>{0, 1, 2.5})));
    EXPECT_TRUE(refusal("kintree_table", npy({2, 3}, std::vector<double>{0, 2, 1, 0, 1, 2})));
    EXPECT_TRUE(refusal("weights", npy({16, 3}, std::vector<float>(48, 0.0f))));
    EXPECT_TRUE(refusal("weights", npy({16, 2}, std::vector<float>(32, 1.0f))));
    EXPECT_TRUE(refusal("posedirs", npy({16, 3, 9}, std::vector<float>(432, 0.0f))));
    EXPECT_TRUE(refusal("shapedirs", npy({15, 3, 1}, std::vector<float>(45, 0.0f))));
}

TEST(AmassMotion, TurnsItsWorldSoThatYIsUp) {
    const AmassMotion motion = motion_of(small_amass_motion());
    EXPECT_EQ(motion.frame_count(), 3);
    EXPECT_EQ(motion.joint_count(), 3);
    EXPECT_NEAR(motion.duration(), 0.2, 1e-12);
    EXPECT_EQ(motion.gender, "male");
    EXPECT_EQ(motion.betas.size(), 4);
    EXPECT_LT((motion.translations.row(1) - Eigen::RowVector3d(1.0, 0.9, -2.1)).norm(), 1e-12);
    EXPECT_LT(motion.rotations[0][0].angularDistance(Eigen::Quaterniond::Identity()), 1e-9);
}

TEST(AmassMotion, BrokenFilesAreRefused) {
    const auto refuses = [](const char* array, const std::string& bytes) {
        Arrays arrays = small_amass_motion();
        arrays.erase(array);
        if (!bytes.empty()) arrays[array] = bytes;
        try {
            motion_of(arrays);
        } catch (const LoadError& error) {
            return std::string(error.what()).find("motion.npz") != std::string::npos;
        }
        return false;
    };
    for (const char* array : {"poses", "trans", "mocap_framerate"})
        EXPECT_TRUE(refuses(array, "")) << array;
    EXPECT_TRUE(refuses("poses", npy({3, 8}, std::vector<double>(24, 0.0))));
    EXPECT_TRUE(refuses("poses", npy({0, 9}, std::vector<double>())));
    EXPECT_TRUE(refuses("trans", npy({2, 3}, std::vector<double>(6, 0.0))));
    EXPECT_TRUE(refuses("mocap_framerate", npy({}, std::vector<double>{0.0})));
    EXPECT_TRUE(refuses("poses", npy({3, 9}, std::vector<double>(27, std::nan("")))));
}

/// The formula of SMPL in AMASS's own world, vertex by vertex, then turned.
Points brute_force(const Points& rest, const Points& joints, double joint1_angle,
                   const Vec3& translation) {
    const Eigen::AngleAxisd root(M_PI / 2.0, Vec3::UnitX()), bend(joint1_angle, Vec3::UnitZ());
    Points x(rest.rows(), 3);
    for (int i = 0; i < rest.rows(); ++i) {
        Vec3 v = rest.row(i);
        const Vec3 j0 = joints.row(0), j1 = joints.row(1);
        if (i >= 8) v = bend * (v - j1) + j1;  // the two upper rings follow joints 1 and 2
        v = root * (v - j0) + j0 + translation;
        x.row(i) << v.x(), v.z(), -v.y();
    }
    return x;
}

TEST(SmplBody, PosesAsTheFormulaSays) {
    const auto model = std::make_shared<const SmplModel>(model_of(small_smpl_model()));
    const AmassMotion motion = motion_of(small_amass_motion());
    SmplBodySettings settings;
    settings.pose_shapes = false;
    const SmplBody body(model, motion, settings);
    EXPECT_NEAR(body.duration(), 1.2, 1e-12);
    const Points rest = model->rest(Eigen::Vector2d(1.0, 0.0)), joints = model->joints(rest);
    for (int frame = 0; frame < 3; ++frame) {
        const Points expected =
            brute_force(rest, joints, 0.25 * M_PI * frame, Vec3(1.0, 2.0 + 0.1 * frame, 0.9));
        EXPECT_LT((body.vertices(1.0 + 0.1 * frame) - expected).cwiseAbs().maxCoeff(), 1e-6);
    }
    EXPECT_LT((body.vertices(5.0) - body.vertices(1.2)).cwiseAbs().maxCoeff(), 1e-12);
    // Skinning alone is what skin_matrices() say.
    const Points skinned =
        skin_points(body.rest_vertices(), body.weights(), body.skin_matrices(1.1));
    EXPECT_LT((body.vertices(1.1) - skinned).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(SmplBody, BeginsAtRestOnTheGround) {
    const auto model = std::make_shared<const SmplModel>(model_of(small_smpl_model()));
    const SmplBody body(model, motion_of(small_amass_motion()));
    EXPECT_LT((body.vertices(0.0) - body.rest_vertices()).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_NEAR(body.rest_vertices().col(1).minCoeff(), 0.0, 1e-12);
    for (const SkinMatrix& matrix : body.skin_matrices(0.0))
        EXPECT_LT((matrix - SkinMatrix::Identity()).cwiseAbs().maxCoeff(), 1e-12);
    const Points before = body.vertices(1.0 - 1e-6), after = body.vertices(1.0 + 1e-6);
    EXPECT_LT((after - before).cwiseAbs().maxCoeff(), 1e-4) << "no jump";
}

TEST(SmplBody, PoseShapesBendTheSkin) {
    const auto model = std::make_shared<const SmplModel>(model_of(small_smpl_model()));
    SmplBodySettings plain;
    plain.pose_shapes = false;
    const AmassMotion motion = motion_of(small_amass_motion());
    const SmplBody with(model, motion), without(model, motion, plain);
    // Number 1 of joint 1: row 0, column 1 of its rotation, here -sin; 0.2 m along z of each.
    const double expected = -0.2 * std::sin(0.25 * M_PI);
    const Points difference = with.vertices(1.1) - without.vertices(1.1);
    EXPECT_LT((difference.col(2).array() - expected).abs().maxCoeff(), 1e-6);
    EXPECT_LT(difference.leftCols(2).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(SmplBody, FingersAreLeftOutWhereOneOfTheTwoHasNone) {
    const auto model_with = [](int joints) {
        SmplModel model = model_of(small_smpl_model());
        model.parents.assign(static_cast<size_t>(joints), 0);
        model.parents[0] = -1;
        model.regressor = Eigen::MatrixXd::Zero(joints, 16);
        model.pose_shapes.resize(48, 0);
        model.weights = std::make_shared<const SkinWeights>(
            sparse_weights(Eigen::MatrixXd::Ones(16, joints), joints, 0.0));
        return std::make_shared<const SmplModel>(model);
    };
    const auto motion_with = [](int joints) {
        AmassMotion motion = motion_of(small_amass_motion());
        for (auto& rotations : motion.rotations) {
            rotations.assign(static_cast<size_t>(joints), Eigen::Quaterniond::Identity());
            rotations.back() = Eigen::AngleAxisd(1.0, Vec3::UnitX());  // the last finger
        }
        return motion;
    };
    const auto moves_finger = [&](int model, int motion) {
        const SmplBody body(model_with(model), motion_with(motion));
        const auto matrices = body.skin_matrices(1.0);
        return (matrices.back().leftCols<3>() - Eigen::Matrix3d::Identity()).norm() > 0.1;
    };
    EXPECT_TRUE(moves_finger(55, 52));
    EXPECT_TRUE(moves_finger(52, 55));
    EXPECT_TRUE(moves_finger(55, 55));
    EXPECT_FALSE(moves_finger(24, 52));
    EXPECT_THROW(moves_finger(55, 21), ArgumentError);
    EXPECT_THROW(SmplBody(nullptr, motion_with(3)), ArgumentError);
}

/// The default body as an SMPL file: its skin and weights, joints amidst what they move most.
Arrays default_body_as_smpl(const Body& body) {
    const auto vertices = static_cast<std::int64_t>(body.rest().rows());
    const auto joints = static_cast<std::int64_t>(body.joints().size());
    std::vector<std::uint32_t> faces, tree;
    for (Eigen::Index k = 0; k < body.faces()->size(); ++k)
        faces.push_back(static_cast<std::uint32_t>(body.faces()->data()[k]));
    for (const Joint& joint : body.joints())
        tree.push_back(static_cast<std::uint32_t>(joint.parent));
    for (std::int64_t j = 0; j < joints; ++j) tree.push_back(static_cast<std::uint32_t>(j));
    std::vector<float> weights(static_cast<size_t>(vertices * joints), 0.0f);
    std::vector<double> share;
    std::vector<std::int32_t> index, begin = {0};
    for (int i = 0; i < vertices; ++i)
        for (int j = 0; j < joints; ++j)
            weights[static_cast<size_t>(i * joints + j)] =
                static_cast<float>(body.weights().at(i, j));
    for (std::int64_t j = 0; j < joints; ++j) {
        Eigen::Index nearest;
        (body.rest().rowwise() - body.joints()[static_cast<size_t>(j)].position.transpose())
            .rowwise()
            .squaredNorm()
            .minCoeff(&nearest);
        index.push_back(static_cast<std::int32_t>(nearest));
        share.push_back(1.0);
        begin.push_back(static_cast<std::int32_t>(index.size()));
    }
    const std::vector<double> rest(body.rest().data(), body.rest().data() + body.rest().size());
    return {{"v_template", npy({vertices, 3}, rest)},
            {"f", npy({static_cast<std::int64_t>(faces.size() / 3), 3}, faces)},
            {"weights", npy({vertices, joints}, weights)},
            {"kintree_table", npy({2, joints}, tree)},
            {"J_regressor_data", npy({joints}, share)},
            {"J_regressor_indices", npy({joints}, index)},
            {"J_regressor_indptr", npy({joints + 1}, begin)}};
}

TEST(SmplBody, ATrainedNetworkDressesIt) {
    const Body own = Body::load_default();
    const auto model = std::make_shared<const SmplModel>(model_of(default_body_as_smpl(own)));
    const size_t joints = own.joints().size();
    std::vector<double> poses, places;
    for (int frame = 0; frame < 12; ++frame) {
        std::vector<double> row(3 * joints, 0.0);
        row[0] = M_PI / 2.0;
        row[3 * static_cast<size_t>(own.joint("Spine")) + 1] = 0.03 * frame;
        poses.insert(poses.end(), row.begin(), row.end());
        places.insert(places.end(), {0.02 * frame, 0.0, 0.0});
    }
    const AmassMotion motion =
        motion_of({{"poses", npy({12, static_cast<std::int64_t>(3 * joints)}, poses)},
                   {"trans", npy({12, 3}, places)},
                   {"mocap_frame_rate", npy({}, std::vector<double>{30.0})}});
    SmplBodySettings settings;
    settings.lead_in = 0.0;
    const SmplBody body(model, motion, settings);
    const Garment shirt = load_garment("tshirt_1000");
    ClothSettings cloth;
    cloth.weights = std::make_shared<const EngineWeights>(
        Weights::load(asset_path("weights/small.safetensors")));
    const auto stepper = make_cloth(shirt, cloth);
    ClothState state = ClothState::at_rest(shirt);
    // Where the skin is at first is not where the default body stands: AMASS turns about the root.
    state.x.rowwise() += (body.vertices(0.0) - own.rest()).colwise().mean();
    const Points before = state.x;
    Boundary boundary;
    boundary.pin_targets.resize(0, 3);
    const double dt = 1.0 / 30.0;
    for (int frame = 0; frame < 11; ++frame) {
        boundary.obstacles = {body.obstacle(frame * dt, (frame + 1) * dt)};
        ASSERT_TRUE(stepper->step(boundary, dt, state).finite) << frame;
    }
    Proximity proximity;
    EXPECT_LT(measure_penetration(proximity, boundary, shirt, state.x).vertex_depth, 1e-3);
    EXPECT_LT(measure_stretch(shirt, state.x).p99, 1.5);
    EXPECT_GT((state.x - before).rowwise().norm().mean(), 0.1) << "it came along";
}

}  // namespace

}  // namespace cloth::smpl_body_test
