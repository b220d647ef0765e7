//! The two small Kalman filters whose noise is tuned: random walk of the rate, and random walk of its acceleration.
//!
//! Random walk (A = H = 1): P- = P + q; K = P-/(P- + 1); x += K (z - x); P = (1 - K) P-; start x = z0, P = 1.
//! Rate and acceleration: F = [[1, dt], [0, 1]], Q = q [[dt^3/3, dt^2/2], [dt^2/2, dt]], H = [1, 0]; start [z0, 0], P = diag(1, 1e6).
//! The measurement variance is 1 and q stands for Q/R: with this start only the ratio matters.

use stillrate::Real;

use crate::tune::lanes::{Candidates, Innovations, has_settled};

/// Initial variance of the acceleration over that of the measurement: as good as unknown.
pub(crate) const ACCELERATION_VARIANCE: f64 = 1e6;

/// `W` random-walk filters.
pub(crate) struct RandomWalks<const W: usize> {
    q: [f64; W],
    p: [f64; W],
    k: [f64; W],
    x: [f64; W],
    innovations: Innovations<W>,
}

impl<const W: usize> Candidates<W> for RandomWalks<W> {
    #[inline(always)]
    fn start(q: &[f64; W], _period_s: f64, first: f64) -> Self {
        Self { q: *q, p: [1.0; W], k: [0.0; W], x: [first; W], innovations: Innovations::start() }
    }

    #[inline(always)]
    fn gain(&mut self) {
        for l in 0..W {
            let predicted = self.p[l] + self.q[l];
            let f = predicted + 1.0;
            let information = 1.0 / f;
            let k = predicted * information;
            let held = self.innovations.take(l, f, information, has_settled(self.k[l], k));
            self.k[l] = f64::select(held, self.k[l], k);
            self.p[l] = f64::select(held, self.p[l], (1.0 - k) * predicted);
        }
    }

    #[inline(always)]
    fn coast(&mut self) {
        for l in 0..W {
            self.p[l] += self.q[l];
        }
        self.innovations.settled = [0.0; W];
    }

    #[inline(always)]
    fn update(&mut self, value: f64) -> [f64; W] {
        let mut innovation = [0.0; W];
        for l in 0..W {
            innovation[l] = value - self.x[l];
            self.x[l] += self.k[l] * innovation[l];
        }
        innovation
    }

    #[inline(always)]
    fn innovations(&self) -> &Innovations<W> {
        &self.innovations
    }

    #[inline(always)]
    fn rate(&self) -> &[f64; W] {
        &self.x
    }
}

/// `W` rate-and-acceleration filters.
pub(crate) struct RateAccelerations<const W: usize> {
    dt: f64,
    /// Process noise of the rate, of both, of the acceleration.
    q: [[f64; W]; 3],
    /// Covariance of the rate, of both, of the acceleration.
    p: [[f64; W]; 3],
    k: [[f64; W]; 2],
    x: [[f64; W]; 2],
    innovations: Innovations<W>,
}

impl<const W: usize> RateAccelerations<W> {
    /// Covariances a step later.
    #[inline(always)]
    fn predicted(&self, l: usize) -> [f64; 3] {
        let [p11, p12, p22] = [self.p[0][l], self.p[1][l], self.p[2][l]];
        let moved = p12 + self.dt * p22;
        [p11 + self.dt * (p12 + moved) + self.q[0][l], moved + self.q[1][l], p22 + self.q[2][l]]
    }
}

impl<const W: usize> Candidates<W> for RateAccelerations<W> {
    #[inline(always)]
    fn start(q: &[f64; W], dt: f64, first: f64) -> Self {
        let (square, cube) = (dt * dt, dt * dt * dt);
        Self {
            dt,
            q: [q.map(|q| q * cube / 3.0), q.map(|q| q * square / 2.0), q.map(|q| q * dt)],
            p: [[1.0; W], [0.0; W], [ACCELERATION_VARIANCE; W]],
            k: [[0.0; W]; 2],
            x: [[first; W], [0.0; W]],
            innovations: Innovations::start(),
        }
    }

    #[inline(always)]
    fn gain(&mut self) {
        for l in 0..W {
            let [p11, p12, p22] = self.predicted(l);
            let f = p11 + 1.0;
            let information = 1.0 / f;
            let [k1, k2] = [p11 * information, p12 * information];
            let still = has_settled(self.k[0][l], k1) && has_settled(self.k[1][l], k2);
            let held = self.innovations.take(l, f, information, still);
            self.k[0][l] = f64::select(held, self.k[0][l], k1);
            self.k[1][l] = f64::select(held, self.k[1][l], k2);
            // Joseph's form of the only entry that could lose its sign is p22 - k2 p12 with k2 p12 <= p22.
            self.p[0][l] = f64::select(held, self.p[0][l], (1.0 - k1) * p11);
            self.p[1][l] = f64::select(held, self.p[1][l], (1.0 - k1) * p12);
            self.p[2][l] = f64::select(held, self.p[2][l], p22 - k2 * p12);
        }
    }

    #[inline(always)]
    fn coast(&mut self) {
        for l in 0..W {
            let [p11, p12, p22] = self.predicted(l);
            self.p[0][l] = p11;
            self.p[1][l] = p12;
            self.p[2][l] = p22;
            self.x[0][l] += self.dt * self.x[1][l];
        }
        self.innovations.settled = [0.0; W];
    }

    #[inline(always)]
    fn update(&mut self, value: f64) -> [f64; W] {
        let mut innovation = [0.0; W];
        for l in 0..W {
            let predicted = self.x[0][l] + self.dt * self.x[1][l];
            innovation[l] = value - predicted;
            self.x[0][l] = predicted + self.k[0][l] * innovation[l];
            self.x[1][l] += self.k[1][l] * innovation[l];
        }
        innovation
    }

    #[inline(always)]
    fn innovations(&self) -> &Innovations<W> {
        &self.innovations
    }

    #[inline(always)]
    fn rate(&self) -> &[f64; W] {
        &self.x[0]
    }
}
