#include "data/body/smpl_model.h"

#include <algorithm>
#include <cmath>

#include "data/core/errors.h"
#include "data/files/npz_file.h"

namespace cloth {

namespace {

const char* const as_published = "use the file as the model's authors have it";

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The array as a matrix: the first axis, or the first two, run over rows.
Eigen::Map<const RowMajor> as_matrix(const NpyArray& array) {
    const auto columns = static_cast<Eigen::Index>(array.shape.back());
    const auto size = static_cast<Eigen::Index>(array.numbers.size());
    return {array.numbers.data(), columns == 0 ? 0 : size / columns, columns};
}

NpyArray of_shape(const NpzFile& file, const std::string& name,
                  const std::vector<std::int64_t>& shape) {
    NpyArray array = file.numbers(name, shape.size());
    for (size_t axis = 0; axis < shape.size(); ++axis)
        if (shape[axis] >= 0 && array.shape[axis] != shape[axis])
            file.fail(name,
                      "has " + std::to_string(array.shape[axis]) + " entries on axis " +
                          std::to_string(axis) + ", where " + std::to_string(shape[axis]) +
                          " are expected",
                      as_published);
    return array;
}

/// Whole numbers from `lowest` on, below `end`.
int index_of(const NpzFile& file, const std::string& name, double number, int lowest, double end) {
    if (!(number >= lowest && number < end) || number != std::floor(number))
        file.fail(name, "names no. " + std::to_string(number) + ", which there is not",
                  as_published);
    return static_cast<int>(number);
}

std::shared_ptr<const Faces> read_faces(const NpzFile& file, std::int64_t vertices) {
    const NpyArray array = of_shape(file, "f", {-1, 3});
    Faces faces(array.shape[0], 3);
    for (size_t k = 0; k < array.numbers.size(); ++k)
        faces.data()[k] = index_of(file, "f", array.numbers[k], 0, static_cast<double>(vertices));
    if (faces.rows() == 0) file.fail("f", "has no face", as_published);
    return std::make_shared<const Faces>(std::move(faces));
}

std::vector<int> read_parents(const NpzFile& file) {
    const NpyArray tree = of_shape(file, "kintree_table", {2, -1});
    const auto joints = static_cast<size_t>(tree.shape[1]);
    if (joints == 0) file.fail("kintree_table", "names no joint", as_published);
    std::vector<int> parents = {-1};  // of the root the file has -1 as it looks without a sign
    for (size_t j = 1; j < joints; ++j)
        parents.push_back(
            index_of(file, "kintree_table", tree.numbers[j], 0, static_cast<double>(j)));
    return parents;
}

Eigen::MatrixXd read_sparse_regressor(const NpzFile& file, std::int64_t joints,
                                      std::int64_t vertices) {
    const std::string name = "J_regressor";
    const NpyArray data = file.numbers(name + "_data", 1);
    const NpyArray indices = of_shape(file, name + "_indices", {data.size()});
    const NpyArray begin = of_shape(file, name + "_indptr", {joints + 1});
    Eigen::MatrixXd regressor = Eigen::MatrixXd::Zero(joints, vertices);
    const double end = static_cast<double>(data.size()) + 1.0;
    for (std::int64_t j = 0; j < joints; ++j) {
        const auto row = static_cast<size_t>(j);
        const int first = index_of(file, name + "_indptr", begin.numbers[row], 0, end);
        const int last = index_of(file, name + "_indptr", begin.numbers[row + 1], first, end);
        for (int k = first; k < last; ++k) {
            const auto at = static_cast<size_t>(k);
            regressor(j, index_of(file, name + "_indices", indices.numbers[at], 0,
                                  static_cast<double>(vertices))) += data.numbers[at];
        }
    }
    return regressor;
}

Eigen::MatrixXd read_regressor(const NpzFile& file, std::int64_t joints, std::int64_t vertices) {
    if (!file.has("J_regressor") && file.has("J_regressor_data"))
        return read_sparse_regressor(file, joints, vertices);
    return as_matrix(of_shape(file, "J_regressor", {joints, vertices}));
}

std::shared_ptr<const SkinWeights> read_skin_weights(const NpzFile& file, std::int64_t vertices,
                                                     std::int64_t joints) {
    const NpyArray array = of_shape(file, "weights", {vertices, joints});
    const auto dense = as_matrix(array);
    for (Eigen::Index i = 0; i < dense.rows(); ++i)
        if (dense.row(i).minCoeff() < 0.0 || !(dense.row(i).sum() > 1e-6) ||
            dense.row(i).maxCoeff() > 1e6)
            file.fail("weights", "of vertex " + std::to_string(i) + " are no shares", as_published);
    return std::make_shared<const SkinWeights>(
        sparse_weights(dense, static_cast<int>(joints), 0.0));
}

/// shapedirs and posedirs: V x 3 x N as 3V x N.
Eigen::MatrixXf read_blend_shapes(const NpzFile& file, const std::string& name,
                                  std::int64_t vertices, std::int64_t count) {
    if (!file.has(name)) return Eigen::MatrixXf(3 * vertices, 0);
    const NpyArray array = of_shape(file, name, {vertices, 3, count});
    const Eigen::MatrixXf shapes = as_matrix(array).cast<float>();
    if (!shapes.allFinite())
        file.fail(name, "holds a number beyond single precision", as_published);
    if (shapes.rows() != 3 * vertices) return Eigen::MatrixXf(3 * vertices, 0);
    return shapes;
}

}  // namespace

SmplModel SmplModel::load(const std::string& path) {
    const NpzFile file(path);
    SmplModel model;
    const NpyArray mean = of_shape(file, "v_template", {-1, 3});
    const std::int64_t vertices = mean.shape[0];
    if (vertices < 3 || vertices > 10000000)
        file.fail("v_template", "has " + std::to_string(vertices) + " vertices", as_published);
    model.mean = as_matrix(mean);
    model.faces = read_faces(file, vertices);
    model.parents = read_parents(file);
    const std::int64_t joints = model.joint_count();
    model.regressor = read_regressor(file, joints, vertices);
    model.weights = read_skin_weights(file, vertices, joints);
    model.shapes = read_blend_shapes(file, "shapedirs", vertices, -1);
    model.pose_shapes =
        read_blend_shapes(file, "posedirs", vertices, file.has("posedirs") ? 9 * (joints - 1) : -1);
    return model;
}

static Points as_points(const Eigen::VectorXf& values) {
    return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(
               values.data(), values.size() / 3, 3)
        .cast<double>();
}

Points SmplModel::rest(const VectorX& betas) const {
    if (betas.size() > shapes.cols() || !betas.allFinite())
        throw ArgumentError("SmplModel: betas",
                            "are " + std::to_string(betas.size()) +
                                ", or not finite; the model has " + std::to_string(shapes.cols()),
                            "leave out those that it has not");
    if (betas.size() == 0) return mean;
    return mean + as_points(shapes.leftCols(betas.size()) * betas.cast<float>());
}

Points SmplModel::pose_offsets(const std::vector<Eigen::Matrix3d>& rotations) const {
    if (pose_shapes.cols() == 0) return Points::Zero(mean.rows(), 3);
    Eigen::VectorXf bends(pose_shapes.cols());
    for (size_t j = 1; j < rotations.size(); ++j) {
        const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> bend =
            rotations[j] - Eigen::Matrix3d::Identity();
        bends.segment<9>(9 * static_cast<Eigen::Index>(j - 1)) =
            Eigen::Map<const Eigen::Matrix<double, 9, 1>>(bend.data()).cast<float>();
    }
    return as_points(pose_shapes * bends);
}

}  // namespace cloth
