//! The configuration objects of `stillrate.platform`, read by the names of their fields.

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use stillrate::GyroNoise;
use stillrate_lab::servo::base::{Base, Recorded};
use stillrate_lab::servo::bench::{Bench, Design};
use stillrate_lab::servo::chain::Link;
use stillrate_lab::servo::controller::Controller;
use stillrate_lab::servo::family::{Family, Tunable};
use stillrate_lab::servo::plant::{Curves, Plant};
use stillrate_lab::servo::search::Range;
use stillrate_lab::settings_map::SettingsError;

use crate::convert::{config_error, settings_from, settings_to};

pub(crate) fn number(object: &Bound<'_, PyAny>, name: &str) -> PyResult<f64> {
    object.getattr(name)?.extract()
}

pub(crate) fn plant_from(object: &Bound<'_, PyAny>) -> PyResult<Plant> {
    let mut plant = Plant::platform_30kg();
    for (name, _, _) in Plant::FIELDS {
        if let Some(slot) = plant.number_mut(name) {
            *slot = number(object, name)?;
        }
    }
    let curves: String = object.getattr("curves")?.extract()?;
    plant.curves = match curves.as_str() {
        "algebraic" => Curves::Algebraic,
        "transcendental" => Curves::Transcendental,
        other => {
            let text = format!("curves = {other} (must be algebraic or transcendental)");
            return Err(config_error(object.py(), &SettingsError::Text(text)));
        }
    };
    Ok(plant)
}

pub(crate) fn controller_from(object: &Bound<'_, PyAny>) -> PyResult<Controller> {
    Ok(Controller {
        kappa: number(object, "kappa")?,
        ko_per_s: number(object, "ko_per_s")?,
        kvi_per_s: number(object, "kvi_per_s")?,
        kd_s: number(object, "kd_s")?,
        rate_demand_max_rad_s: number(object, "rate_demand_max_dps")?.to_radians(),
        angle_from_filtered: object.getattr("angle_from_filtered")?.extract()?,
        inclinometer_time_s: number(object, "inclinometer_time_s")?,
    })
}

pub(crate) fn controller_to<'py>(py: Python<'py>, c: &Controller) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("kappa", c.kappa)?;
    dict.set_item("ko_per_s", c.ko_per_s)?;
    dict.set_item("kvi_per_s", c.kvi_per_s)?;
    dict.set_item("kd_s", c.kd_s)?;
    Ok(dict)
}

pub(crate) fn base_from(object: &Bound<'_, PyAny>) -> PyResult<Base> {
    let kind: String = object.getattr("kind")?.extract()?;
    Ok(match kind.as_str() {
        "tilt" => Base::Tilt {
            amplitude_rad: number(object, "amplitude_deg")?.to_radians(),
            duration_s: number(object, "duration_s")?,
        },
        "sine" => Base::Sine {
            amplitude_rad: number(object, "amplitude_deg")?.to_radians(),
            frequency_hz: number(object, "frequency_hz")?,
            ramp_s: number(object, "ramp_s")?,
        },
        "constant" => Base::Constant { angle_rad: number(object, "angle_deg")?.to_radians() },
        _ => {
            let samples: PyReadonlyArray1<'_, f64> = object.getattr("rate_dps")?.extract()?;
            let rate: Vec<f64> = samples.as_array().iter().map(|v| v.to_radians()).collect();
            let range = number(object, "range_deg")?.to_radians();
            let recorded = Recorded::new(&rate, number(object, "sample_rate_hz")?, range);
            Base::Recorded(recorded.map_err(|e| config_error(object.py(), &e))?)
        }
    })
}

pub(crate) fn chain_from(list: &Bound<'_, PyList>) -> PyResult<Vec<Link>> {
    list.iter()
        .map(|link| {
            let (method, settings): (String, Bound<'_, PyDict>) = link.extract()?;
            Ok((method, settings_from(&settings)?))
        })
        .collect()
}

pub(crate) fn chain_to<'py>(py: Python<'py>, chain: &[Link]) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for (method, settings) in chain {
        list.append((method, settings_to(py, settings)?))?;
    }
    Ok(list)
}

pub(crate) fn bench_from(object: &Bound<'_, PyAny>) -> PyResult<Bench> {
    let noise = object.getattr("noise")?;
    Ok(Bench {
        plant: plant_from(&object.getattr("plant")?)?,
        sample_rate_hz: number(object, "sample_rate_hz")?,
        dt_s: number(object, "dt_s")?,
        delay_s: number(object, "delay_s")?,
        noise: GyroNoise {
            density_dps_sqrt_hz: number(&noise, "density_dps_sqrt_hz")?,
            rate_random_walk_dps_sqrt_s: number(&noise, "rate_random_walk_dps_sqrt_s")?,
        },
        bias_dps: number(object, "bias_dps")?,
        amplitude_deg: number(object, "amplitude_deg")?,
        frequency_hz: number(object, "frequency_hz")?,
    })
}

pub(crate) fn design_from(controller: &Bound<'_, PyAny>, parameters: Vec<f64>) -> PyResult<Design> {
    Ok(Design { controller: controller_from(controller)?, parameters })
}

pub(crate) fn family_from(object: &Bound<'_, PyAny>) -> PyResult<Family> {
    let open: Vec<(usize, String, f64, f64, bool)> = object.getattr("open")?.extract()?;
    let open = open
        .into_iter()
        .map(|(link, field, low, high, logarithmic)| Tunable { link, field, range: Range { low, high, logarithmic } })
        .collect();
    Ok(Family {
        name: object.getattr("name")?.extract()?,
        chain: chain_from(&object.call_method0("links")?.cast_into::<PyList>()?)?,
        open,
        linear: object.getattr("linear")?.extract()?,
    })
}
