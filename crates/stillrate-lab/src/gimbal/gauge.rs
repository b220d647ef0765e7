//! From one gauge to the other, exactly: a common rotation of the axes of all instruments and of the attitude.
//!
//! The true platform frame is a convention. Turning it by a rotation Q leaves every output as it was if all input axes are turned with it:
//! I'_i -> Q I'_i, a_i -> Q a_i, R -> Q R. Q is chosen so that the instrument triad of the wanted gauge stands with its x axis on x and its y axis
//! in the x-y plane; the mounting angles are read off the turned axes. The gyro's
//! own roll about its input axis is not a coefficient; what is left of it after turning is of second order (angle times g-sensitive term).

use nalgebra::{Matrix3, Vector3};
use stillrate::Real;
use stillrate::gimbal::coefficients::{
    FORCE_ABOUT_OUTPUT, FORCE_ABOUT_PENDULOUS, G_OUTPUT, G_SPIN, GYRO_ABOUT_OUTPUT, GYRO_ABOUT_SPIN,
};
use stillrate::gimbal::rotation::logarithm;
use stillrate::gimbal::{Coefficients, ForceAxis, Gauge, GyroAxes, Linearisation, Triads};

/// arcsin by the quotient of the core.
fn arc_sine(x: f64) -> f64 {
    x.angle_over((1.0 - x * x).max(0.0).root())
}

/// Rotation that puts `x` on platform axis `first` and `y` into the plane of `first` and `second`.
fn aligning(x: &Vector3<f64>, y: &Vector3<f64>, first: usize, second: usize) -> Matrix3<f64> {
    let length = |v: &Vector3<f64>| v.dot(v).root();
    let e1 = x / length(x);
    let rest = y - e1 * e1.dot(y);
    let e2 = rest / length(&rest);
    let third = 3 - first - second;
    let right_handed = (second + 3 - first) % 3 == 1;
    let e3 = if right_handed { e1.cross(&e2) } else { e2.cross(&e1) };
    let mut q = Matrix3::zeros();
    q.set_row(first, &e1.transpose());
    q.set_row(second, &e2.transpose());
    q.set_row(third, &e3.transpose());
    q
}

/// The same head described in another gauge; `Gauge::None` changes nothing.
///
/// # Example
/// ```
/// use stillrate::gimbal::{DEFAULT_SCALE, Gauge, Triads};
/// use stillrate_lab::gimbal::{draw, to_gauge};
/// let a = draw(&DEFAULT_SCALE, 1.0, 3);
/// let b = to_gauge(&a, Gauge::Gyro, &Triads::default());
/// assert!(b[15].abs() < 1e-15 && b[27] != 0.0);
/// let back = to_gauge(&b, Gauge::Accelerometer, &Triads::default());
/// assert!(a.iter().zip(&back).all(|(p, q)| (p - q).abs() < 1e-9));
/// ```
#[must_use]
pub fn to_gauge(x: &Coefficients, gauge: Gauge, triads: &Triads) -> Coefficients {
    let axes_of_gyro =
        |x: &Coefficients, i: usize| GyroAxes::new(&triads.gyro[i], x[GYRO_ABOUT_OUTPUT + i], x[GYRO_ABOUT_SPIN + i]);
    let gyros: [GyroAxes; 3] = core::array::from_fn(|i| axes_of_gyro(x, i));
    let forces: [ForceAxis; 3] = core::array::from_fn(|i| {
        ForceAxis::new(&triads.accelerometer[i], x[FORCE_ABOUT_PENDULOUS + i], x[FORCE_ABOUT_OUTPUT + i])
    });
    let q = match gauge {
        Gauge::Accelerometer => {
            aligning(&forces[0].input, &forces[1].input, triads.accelerometer[0][0], triads.accelerometer[1][0])
        }
        Gauge::Gyro => aligning(&gyros[0].input, &gyros[1].input, triads.gyro[0][0], triads.gyro[1][0]),
        Gauge::None => Matrix3::identity(),
    };
    let mut y = *x;
    let phi = -logarithm(&(q * Linearisation::of(x).rotation));
    y[..3].copy_from_slice(phi.as_slice());
    for i in 0..3 {
        // I' = cos ds cos do I + sin ds O - cos ds sin do S
        let input = q * gyros[i].input;
        let [along, out, spin] = triads.gyro[i];
        y[GYRO_ABOUT_SPIN + i] = arc_sine(input[out]);
        y[GYRO_ABOUT_OUTPUT + i] = (-input[spin]).angle_over(input[along]);
        // a = cos thp cos tho I + cos thp sin tho P - sin thp O
        let input = q * forces[i].input;
        let [along, pendulous, output] = triads.accelerometer[i];
        y[FORCE_ABOUT_PENDULOUS + i] = arc_sine(-input[output]);
        y[FORCE_ABOUT_OUTPUT + i] = input[pendulous].angle_over(input[along]);
        // The g-sensitive terms along output and spin axis keep their vector: kgO O' + kgS S' across the turned input axis.
        let across = q * (gyros[i].output * x[G_OUTPUT + i] + gyros[i].spin * x[G_SPIN + i]);
        let turned = axes_of_gyro(&y, i);
        y[G_OUTPUT + i] = across.dot(&turned.output);
        y[G_SPIN + i] = across.dot(&turned.spin);
    }
    for fixed in gauge.fixed(triads).into_iter().flatten() {
        // Zero by construction; what remains is rounding.
        y[fixed] = 0.0;
    }
    y
}
