// SPDX-License-Identifier: GPL-3.0-or-later
// Section 5: frames, and how forces, velocities and accelerations are carried between them.
#include "crosscheck/audit/trial.hpp"

namespace dynwitness::audit {

std::vector<Claim> frames() {
  std::vector<Claim> claims;

  // the moment of any two forces about a point is the sum of (place - point) x force
  claims.push_back(
      Claim("eq1", "5.2", "Force and moment at another reference point")
          .printed("`f_1 = f_2`, `m_1 = m_2 + r_12 x f_2` with `r_12` from 1 to 2",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const Vector3<T> p_1 = at.vector(), p_2 = at.vector();
                     Vector3<T> m_1 = Vector3<T>::Zero(), m_2 = m_1, f_2 = m_1;
                     for (int k = 0; k < 2; ++k) {
                       const Vector3<T> place = at.vector(), f = at.vector();
                       f_2 += f;
                       m_1 += (place - p_1).cross(f);
                       m_2 += (place - p_2).cross(f);
                     }
                     const Vector3<T> r_12 = p_2 - p_1;
                     at.equal("moment", m_1, m_2 + r_12.cross(f_2));
                     at.equal("our code", m_1,
                              (Transform<T>{Matrix3<T>::Identity(), -r_12} * Force<T>{f_2, m_2}).moment);
                   }))
          .why("A moment about 1 counts each force with its lever from 1; the levers from 1 are those "
               "from 2 plus the vector from 1 to 2.")
          .in("recursive/spatial.hpp"));

  return claims;
}

}  // namespace dynwitness::audit
