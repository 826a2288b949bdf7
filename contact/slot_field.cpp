#include "contact/slot_field.hpp"

namespace quern {

template <int Dim>
Mat<Dim> inverse_mass(const Slot<Dim>& slot, const Vec<Dim>& r, bool exact) {
    Eigen::Matrix<double, n_spin<Dim>, Dim> YrJ = Eigen::Matrix<double, n_spin<Dim>, Dim>::Zero();
    if (slot.rotates)
        for (int a = 0; a < Dim; ++a) YrJ.col(a) = slot.Y * moment(r, Vec<Dim>(Vec<Dim>::Unit(a)));
    Mat<Dim> W = Mat<Dim>::Zero();
    if (!exact) {
        for (int a = 0; a < Dim; ++a) W.col(a) = Vec<Dim>::Unit(a) / slot.m + cross(Spin<Dim>(YrJ.col(a)), r);
        return W;
    }
    for (int k = 0; k < slot.n_support; ++k) {
        const Support<Dim>& e = slot.support[k];
        Mat<Dim> B;
        for (int a = 0; a < Dim; ++a)
            B.col(a) = Vec<Dim>::Unit(a) / slot.m + cross(Spin<Dim>(YrJ.col(a)), Vec<Dim>(e.d - slot.xb));
        W += e.mw * e.w * B.transpose() * B;
    }
    return W;
}

template Mat<2> inverse_mass<2>(const Slot<2>&, const Vec<2>&, bool);
template Mat<3> inverse_mass<3>(const Slot<3>&, const Vec<3>&, bool);

}  // namespace quern
