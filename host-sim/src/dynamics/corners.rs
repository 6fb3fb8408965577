//! Positions of the corners around the circle, and the plane through them.

/// Largest number of axes.
pub const MAX: usize = 6;

/// Degrees of freedom of a plane, and of a platform that lies in it: heave and two tilts.
pub const FREEDOMS: usize = 3;

/// N corners at equal angles on a circle.
///
/// The plane closest to their heights has the mean height. Its slope along each of two axes is `share/ρ · Σ height · cos`
/// (or sin). Two corners define a slope along one axis only, and one corner defines none.
#[derive(Clone, Debug)]
pub struct Corners {
    count: usize,
    /// Contribution of a metre at corner i to each freedom.
    share: [[f64; FREEDOMS]; MAX],
    /// Contribution of each freedom to the height of corner i.
    height: [[f64; FREEDOMS]; MAX],
}

impl Corners {
    /// Creates `count` corners, 1 to 6, on a circle of `radius_m`.
    pub fn new(count: usize, radius_m: f64) -> Self {
        assert!((1..=MAX).contains(&count), "1 to {MAX} corners");
        let mut corners = Self {
            count,
            share: [[0.0; FREEDOMS]; MAX],
            height: [[0.0; FREEDOMS]; MAX],
        };
        let share = if count == 2 { 0.5 } else { 2.0 / count as f64 };
        for i in 0..count {
            let angle = std::f64::consts::TAU * i as f64 / count as f64;
            let around = match count {
                1 => [0.0, 0.0],
                2 => [angle.cos(), 0.0],
                _ => [angle.cos(), angle.sin()],
            };
            corners.share[i][0] = 1.0 / count as f64;
            corners.height[i][0] = 1.0;
            for (axis, around) in around.into_iter().enumerate() {
                corners.share[i][axis + 1] = share * around / radius_m;
                corners.height[i][axis + 1] = radius_m * around;
            }
        }
        corners
    }

    /// Number of corners.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Largest deviation of a value at a corner from the plane that is closest to all values. It is 0 for up to three corners.
    pub fn warp(&self, values: &[f64]) -> f64 {
        if values.len() <= 3 {
            return 0.0;
        }
        let plane = self.plane(values);
        let off = |(i, value): (usize, &f64)| (value - self.height(&plane, i)).abs();
        values.iter().enumerate().map(off).fold(0.0, f64::max)
    }

    /// Returns the heave (m, or m/s …) and slopes (rad …) of the plane closest to corners of these heights.
    #[inline]
    pub fn plane(&self, heights: &[f64]) -> [f64; FREEDOMS] {
        let mut plane = [0.0; FREEDOMS];
        for (share, height) in self.share.iter().zip(heights) {
            for (plane, share) in plane.iter_mut().zip(share) {
                *plane += share * height;
            }
        }
        plane
    }

    /// Returns the height of corner `i` on a plane.
    pub fn height(&self, plane: &[f64; FREEDOMS], i: usize) -> f64 {
        let of = &self.height[i];
        of[0] * plane[0] + of[1] * plane[1] + of[2] * plane[2]
    }

    /// Contribution of corner `i` to each freedom of the plane, per metre.
    pub fn share(&self, i: usize) -> [f64; FREEDOMS] {
        self.share[i]
    }

    /// Heave force and tilting moments of a force of 1 N at corner `i`.
    pub fn force(&self, i: usize) -> [f64; FREEDOMS] {
        self.height[i]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, corners in one plane appear warped, or warped corners appear to lie in one plane.
    #[test]
    fn corner_heights_of_a_plane_return_the_plane() {
        for count in 2..=MAX {
            let corners = Corners::new(count, 0.25);
            let slope_y = if count == 2 { 0.0 } else { -0.02 };
            let plane = [0.1, 0.03, slope_y];
            let heights: Vec<f64> = (0..count).map(|i| corners.height(&plane, i)).collect();
            for (found, given) in corners.plane(&heights).into_iter().zip(plane) {
                assert!((found - given).abs() < 1e-15, "{count} corners");
            }
        }
    }

    /// If this fails, the fitted plane is not the closest one: the residual heights must be orthogonal to every plane.
    #[test]
    fn residual_heights_contain_no_plane() {
        for count in 4..=MAX {
            let corners = Corners::new(count, 0.25);
            let heights: Vec<f64> = (0..count)
                .map(|i| ((7 * i * i) % 11) as f64 * 1e-3)
                .collect();
            let plane = corners.plane(&heights);
            let left: Vec<f64> = (0..count)
                .map(|i| heights[i] - corners.height(&plane, i))
                .collect();
            assert!(left.iter().any(|left| left.abs() > 1e-4), "{count} corners");
            assert!(corners.plane(&left).iter().all(|f| f.abs() < 1e-15));
        }
    }
}
